// `puckloop bench`: performance figures, each measured beside a reference that the same machine runs in turn.

#include "base/error.h"
#include "cosim/interrupt.h"
#include "emu/dspic/core/core_bench.h"
#include "tools/bench/rab_scenario.h"
#include "tools/bench/rab_speed.h"
#include "tools/bench/reference.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/commands.h"
#include "tools/commands/bench_rab.h"
#include "tools/run/run_scenario.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <functional>
#include <memory>
#include <vector>

namespace puckloop::tools {

namespace {

/// Where this program was built; `bench` works from any folder.
const std::filesystem::path kHello = PUCKLOOP_SCENARIOS "/hello.toml";
const std::filesystem::path kMainImage = PUCKLOOP_SCENARIOS "/../firmware/epuck/epuck.hex";
const std::filesystem::path kRabImage = PUCKLOOP_SCENARIOS "/../firmware/rab/rab.hex";

struct Options {
    std::filesystem::path scenario;  ///< empty: the project's hello.toml
    std::string image;
    std::vector<std::string> cases{"core", "scenario"};
    std::filesystem::path rab_image = kRabImage;
    double simulated_s = 20.0;
    double slice_s = 0.4;
    int rounds = 5;
    bool json = false;
};

/// One figure over several rounds, and its ratio to the reference measured right before it.
struct Figure {
    std::string name;
    std::string unit;
    std::vector<double> values, ratios;
};

double median(std::vector<double> values) {
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

Figure measure(const std::string& name, const std::string& unit, const Options& options,
               const std::function<double()>& once) {
    Figure figure{name, unit, {}, {}};
    for (int round = 0; round < options.rounds; ++round) {
        const double reference = reference_speed(options.slice_s / 4);
        figure.values.push_back(once());
        figure.ratios.push_back(figure.values.back() / reference);
    }
    return figure;
}

double real_time_factor(const std::filesystem::path& scenario, double seconds, bool in_process,
                        const std::filesystem::path& folder) {
    RunRequest request;
    request.scenario = scenario;
    request.out = folder;
    request.duration = seconds;
    request.in_process = in_process;
    const cosim::InterruptGuard interrupt;
    const cosim::Outcome outcome = run_scenario(set_up(request), request, {}, &interrupt);
    if (!outcome.success || outcome.reason == cosim::EndReason::Interrupted) throw RunError(outcome.text);
    return cosim::to_seconds(outcome.simulated) / outcome.wall_s;
}

/// A folder for the runs' results that goes with the measurement.
class Scratch {
  public:
    Scratch()
        : path_(std::filesystem::temp_directory_path() / fmt::format("puckloop_bench_{}", ::getpid())) {}
    ~Scratch() {
        std::error_code ignored;
        std::filesystem::remove_all(path_, ignored);
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// The chosen firmware for the board, and the original where somebody has it.
std::vector<std::filesystem::path> rab_images(const Options& options) {
    std::vector<std::filesystem::path> images{options.rab_image};
    if (const char* folder = std::getenv("PUCKLOOP_IMAGES")) {
        const std::filesystem::path original = std::filesystem::path(folder) / "randb.hex";
        if (std::filesystem::exists(original)) images.push_back(original);
    }
    return images;
}

void measure_core(const Options& options, std::vector<Figure>& figures) {
    const auto millions = [](const dspic::CoreBenchResult& result) {
        return result.instructions_per_second() * 1e-6;
    };
    figures.push_back(measure("core, compute loop", "M instructions/s", options,
                              [&] { return millions(dspic::bench_compute_loop(options.slice_s)); }));
    if (!options.image.empty()) {
        figures.push_back(measure("core, image, every cycle", "M instructions/s", options, [&] {
            return millions(dspic::bench_image(options.image, options.slice_s));
        }));
        figures.push_back(measure("chip, image, idle skipped", "x real time", options, [&] {
            const auto result = dspic::bench_image(options.image, options.slice_s, true);
            constexpr double kCyclesPerSecond = 14'745'600.0;  // FCY of the e-puck
            return static_cast<double>(result.cycles) / kCyclesPerSecond / result.wall_s;
        }));
    }
}

/// Boards alone, one at a time.
void measure_boards(const Options& options, std::vector<Figure>& figures) {
    for (const auto& [work, title] :
         {std::pair{RabWork::Idle, "idle"}, std::pair{RabWork::Sending, "sending"}})
        for (const std::filesystem::path& image : rab_images(options))
            figures.push_back(measure(fmt::format("rab board, {}, {}", title, image.filename().string()),
                                      "x real time", options,
                                      [&] { return rab_board_speed(image, work, options.slice_s); }));
}

void measure_scenario(const Options& options, std::vector<Figure>& figures) {
    const Scratch scratch;
    const auto scenario = options.scenario.empty() ? kHello : options.scenario;
    const std::string name = scenario.filename().string();
    for (const bool in_process : {true, false})
        figures.push_back(measure(
            name + (in_process ? ", one process" : ", a process a node"), "x real time", options,
            [&] { return real_time_factor(scenario, options.simulated_s, in_process, scratch.path()); }));
}

/// `name` is "rab" and the number of robots.
void measure_rab_boards(const std::string& name, const Options& options, std::vector<Figure>& figures) {
    constexpr double kShare = 0.2;  // of the duration: boards that are never idle take their time
    const Scratch scratch;
    const int robots = name.back() - '0';
    const auto scenario =
        write_rab_scenario(scratch.path() / "scenario", robots, kMainImage, options.rab_image);
    figures.push_back(measure(name + ", one process", "x real time", options, [&] {
        return real_time_factor(scenario, kShare * options.simulated_s, true, scratch.path());
    }));
}

std::vector<Figure> measure_all(const Options& options) {
    std::vector<Figure> figures;
    for (const std::string& name : options.cases) {
        if (name == "core")
            measure_core(options, figures);
        else if (name == "board")
            measure_boards(options, figures);
        else if (name == "scenario")
            measure_scenario(options, figures);
        else
            measure_rab_boards(name, options, figures);
    }
    return figures;
}

void print(const std::vector<Figure>& figures, bool as_json) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    if (!as_json)
        fmt::print("{:32} {:>10} {:>10} {:>10}  {:18} {:>12}\n", "", "median", "lowest", "highest", "",
                   "/reference");
    for (const Figure& figure : figures) {
        const auto [low, high] = std::minmax_element(figure.values.begin(), figure.values.end());
        if (as_json)
            json.push_back({{"name", figure.name},
                            {"unit", figure.unit},
                            {"median", median(figure.values)},
                            {"lowest", *low},
                            {"highest", *high},
                            {"ratio_to_reference", median(figure.ratios)}});
        else
            fmt::print("{:32} {:10.1f} {:10.1f} {:10.1f}  {:18} {:12.4f}\n", figure.name,
                       median(figure.values), *low, *high, figure.unit, median(figure.ratios));
    }
    if (as_json)
        fmt::print("{}\n", json.dump(2));
    else
        fmt::print("reference: million steps a second of a chain of dependent integer operations, run beside "
                   "each measurement\n");
}

}  // namespace

void declare_bench(Command& app, int& status) {
    Command* command =
        app.add_subcommand("bench", "measure the core and a scenario against a reference of this machine");
    auto options = std::make_shared<Options>();
    command->add_option("--scenario", options->scenario, "scenario to time (default scenarios/hello.toml)")
        ->type_name("SCENARIO");
    command->add_option("--image", options->image, "firmware image to run on the bare chip as well")
        ->type_name("IMAGE");
    command
        ->add_option(
            "--case", options->cases,
            "what to measure: core, board = one range-and-bearing board alone, scenario, rab1, rab2, rab8 = "
            "so many robots with such boards in one process (repeatable; default core and scenario)")
        ->allow_extra_args(false)
        ->check(one_of({"core", "board", "scenario", "rab1", "rab2", "rab8"}));
    command
        ->add_option("--rab-image", options->rab_image, "firmware of these boards (default: the project's)")
        ->type_name("IMAGE");
    command->add_option("--duration", options->simulated_s, "simulated seconds of each run of the scenario")
        ->check(positive_number())
        ->type_name("S");
    command->add_option("--rounds", options->rounds, "measurements of each figure")
        ->check(whole_number_between(1, 100))
        ->type_name("N");
    command->add_flag("--json", options->json, "print JSON");
    declare_bench_rab(*command, status);
    command->callback([options, command, &status] {
        if (command->subcommand_given()) return;
        print(measure_all(*options), options->json);
        status = 0;
    });
}

}  // namespace puckloop::tools
