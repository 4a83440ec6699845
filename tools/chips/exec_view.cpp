#include "tools/chips/exec_view.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "ends/uart_spec.h"
#include "scenarios/reader/events/command_text.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

namespace fs = std::filesystem;

std::string quoted(const std::string& text) {
    return scenarios::toml_value({text});
}

/// What is at a UART: for nothing a line that nobody is at, into which the page can type.
std::string end_of(const exec::ExecOptions& options, std::size_t unit) {
    const std::optional<std::string>& end = options.uart.at(unit);
    if (!end) return "script:/dev/null";
    if (exec::parse_uart_spec(fmt::format("--uart{}", unit + 1), *end).kind != exec::UartSpec::Kind::Script)
        throw InputError("", fmt::format("--uart{}", unit + 1),
                         fmt::format("'{}' does not go with --view, whose run can go back", *end),
                         "script:FILE, or none: the page types into the line");
    return "script:" + fs::absolute(end->substr(end->find(':') + 1)).string();
}

std::string keys_of_all(const exec::ExecOptions& options) {
    const exec::TargetOptions& target = options.bench.target;
    std::string text = fmt::format("firmware = {}\nadc_noise = {}\n",
                                   quoted(fs::absolute(options.image).string()), target.adc_noise_counts);
    text += fmt::format("{} = \"{} ppm\"\n",
                        options.bench.board == "tam" ? "resonator_error" : "crystal_error", target.chip.ppm);
    if (options.resets.empty()) return text;
    std::string times;
    for (const double time : options.resets)
        times += fmt::format("{}\"{} s\"", times.empty() ? "" : ", ", time);
    return text + fmt::format("reset = [{}]\n", times);
}

std::string pic_keys(const exec::ExecOptions& options, const std::string& revision,
                     const std::vector<std::string>& errata) {
    std::string text = keys_of_all(options);
    text += fmt::format("board = \"{}\"\nselector = {}\n", revision, options.bench.target.selector);
    for (std::size_t unit = 0; unit < options.uart.size(); ++unit)
        text += fmt::format("uart{} = {}\n", unit + 1, quoted(end_of(options, unit)));
    if (!errata.empty()) text += fmt::format("errata = [\"{}\"]\n", fmt::join(errata, "\", \""));
    if (!options.nvm.empty()) text += fmt::format("nvm = {}\n", quoted(fs::absolute(options.nvm).string()));
    return text;
}

void refuse_of_pic(const exec::ExecOptions& options) {
    const std::string what = fmt::format("does not go with --view and --board {}", options.bench.board);
    for (std::size_t unit = 0; unit < options.uart.size(); ++unit)
        if (options.uart.at(unit))
            throw InputError("", fmt::format("--uart{}", unit + 1), what, "--board pic, or a scenario");
    if (!options.resets.empty() && options.bench.board == "rab")
        throw InputError("", "--reset-at", what, "a fault `reset` at that time");
    if (!options.nvm.empty()) throw InputError("", "--nvm", what, "--board pic, or a scenario");
}

}  // namespace

const std::vector<std::string>& options_with_view() {
    static const std::vector<std::string> names{"--view",           "--board",  "IMAGE",       "--seconds",
                                                "--seed",           "--uart1",  "--uart2",     "--selector",
                                                "--board-revision", "--errata", "--ppm",       "--adc-noise",
                                                "--reset-at",       "--nvm",    "--log-level", "--log-file"};
    return names;
}

fs::path write_board_scenario(const exec::ExecOptions& options, const std::string& revision,
                              const std::vector<std::string>& errata) {
    const std::string& board = options.bench.board;
    if (board.empty()) throw InputError("", "--mcu", "a chip alone has no page", "--board pic, rab or tam");
    if (!options.image.empty() && !fs::is_regular_file(options.image))
        throw InputError(options.image, "", "no such file", "a firmware image");
    if (options.image.empty()) throw InputError("", "--view", "there is no image", "a firmware file");
    std::string text =
        "# A board alone, written by `puckloop exec --view`; docs/scenario.md has what can be around it.\n"
        "[run]\nallow = [\"hung\"]\n";
    text += fmt::format("seed = {}\n", options.bench.target.seed);
    text += fmt::format("duration = \"{} s\"\n\n", options.seconds.value_or(60.0));
    text += "[arena]\nsize = [\"1 m\", \"1 m\"]\n\n";
    constexpr const char* kRobot =
        "[[robot]]\nname = \"board\"\nposition = [\"0 cm\", \"0 cm\"]\n\n[robot.pic]\n";
    if (board == "pic") {
        text += kRobot + pic_keys(options, revision, errata);
    } else if (board == "rab") {
        refuse_of_pic(options);
        text += kRobot + std::string("firmware = \"own\"\n\n[robot.rab]\n") + keys_of_all(options);
    } else {
        refuse_of_pic(options);
        text +=
            "[[tam]]\nname = \"board\"\nposition = [\"0 cm\", \"0 cm\"]\nconsole = \"script:/dev/null\"\n" +
            keys_of_all(options);
    }
    const fs::path file = fs::path("out") / ("exec_" + fs::path(options.image).stem().string() + ".toml");
    make_folder(file.parent_path());
    write_file(file, text);
    return file;
}

}  // namespace puckloop::tools
