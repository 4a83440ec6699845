// `puckloop exec`: one chip or board alone on the bench.

#include "base/error.h"
#include "bench/options.h"
#include "emu/chip/translate/translation_switch.h"
#include "tools/chips/chips.h"
#include "tools/chips/exec_view.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/log_options.h"
#include "tools/cli/other_programs.h"
#include "tools/cli/time_check.h"
#include "tools/files/scenario_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <memory>

namespace puckloop::tools {

namespace {

constexpr double kLongestRun = 1e6;  // seconds
constexpr std::uint64_t kMostCycles = 10'000'000'000'000;
constexpr std::uint64_t kMostSeeds = ~std::uint64_t{0};
constexpr double kSlowestBaud = 50, kFastestBaud = 4e6;
constexpr double kSlowestCrystal = 1e5, kFastestCrystal = 4e7;
constexpr double kSlowestI2c = 1e3, kFastestI2c = 1e6;
constexpr double kWorstCrystal = 1e5;  // ppm

/// `--fosc`: the word that is in force on the robot, the image's own, or a given one.
std::optional<std::uint16_t> fosc_word(const std::string& text, std::optional<std::uint16_t> robot) {
    if (text == "robot") return robot;
    if (text == "image") return std::nullopt;
    std::uint16_t word = 0;
    const char* const last = text.data() + text.size();
    if (text.starts_with("0x")) {
        const auto [end, error] = std::from_chars(text.data() + 2, last, word, 16);
        if (error == std::errc{} && end == last && text.size() > 2) return word;
    }
    throw InputError("", "--fosc", fmt::format("'{}' is not a configuration word", text),
                     "robot, image or 0xWORD");
}

/// "0xFF,0xD9,0xFD" or with the lock byte behind.
std::vector<std::uint8_t> fuse_bytes(const std::string& text) {
    constexpr std::size_t kFewest = 3, kMost = 4;
    std::vector<std::uint8_t> bytes;
    const auto wrong = [&] {
        return InputError("", "--fuses", fmt::format("'{}' are no fuse bytes", text),
                          "0xLOW,0xHIGH,0xEXTENDED, perhaps ,0xLOCK after them");
    };
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find(',', at), text.size());
        const std::string word = text.substr(at, end - at);
        std::uint8_t byte = 0;
        const char* const last = word.data() + word.size();
        if (!word.starts_with("0x") || word.size() == 2) throw wrong();
        const auto [stop, error] = std::from_chars(word.data() + 2, last, byte, 16);
        if (error != std::errc{} || stop != last) throw wrong();
        bytes.push_back(byte);
        at = end + 1;
    }
    if (bytes.size() < kFewest || bytes.size() > kMost) throw wrong();
    return bytes;
}

struct ExecArguments {
    exec::ExecOptions options;
    std::string fosc = "robot", fuses, revision = "1.2";
    std::vector<std::string> errata;
    std::optional<double> crystal_hertz, baud;
    std::array<std::optional<double>, 2> uart_baud;
    LogOptions log;
    bool realtime = false;
    bool unpaced = false;
    bool interpret = false;
    bool view = false;
};

/// The board whose chip the image is for, said on standard error.
std::string guess_board(const std::string& image) {
    if (image.empty())
        throw InputError("", "exec", "no board is on the bench", "an image, --mcu CHIP or --board BOARD");
    const std::string board = exec::board_for(image);
    fmt::print(stderr, "puckloop: note: {} is for the {}: --board {}\n", image,
               exec::defaults_of("", board).mcu, board);
    return board;
}

void describe(Command& app, ExecArguments& a) {
    exec::ExecOptions& o = a.options;
    exec::TargetOptions& t = o.bench.target;
    auto* mcu = app.add_option("--mcu", o.bench.mcu,
                               "the chip alone, nothing connected: dspic30f6014a, dspic33fj256gp710 or "
                               "atmega1284p (its USART0 and 1 are uart1 and 2)");
    auto* board =
        app.add_option("--board", o.bench.board,
                       "the chip on its board: pic (the e-puck main board), rab (range and bearing) or tam");
    mcu->excludes(board);
    app.add_option("IMAGE", o.image,
                   "firmware (without --board and --mcu for the board whose chip it is for): Intel HEX, ELF "
                   "(XC16, avr-gcc) or COFF (C30)");
    auto* seconds =
        app.add_option("--seconds", o.seconds, "budget in simulated seconds (60 if nobody live is at an end)")
            ->check(seconds_between(0.0, kLongestRun))
            ->type_name("TIME");
    app.add_option("--cycles", o.cycles, "budget in instruction cycles")
        ->check(count_up_to(kMostCycles))
        ->excludes(seconds);
    app.add_option(
           "--stop-at", o.stop_at,
           "symbol, 0xPC or FILE:LINE (ELF with debug information); status 0 when reached, 1 when the budget "
           "ends first")
        ->allow_extra_args(false);
    app.add_option(
           "--gdb", o.gdb,
           "wait for GDB at unix:PATH (this user's alone) or :PORT (on 127.0.0.1, open to every user of this "
           "machine; 0: a free one, named on standard error), "
           "with the chip at its first instruction; without --seconds the run has no end "
           "(docs/debugging.md)")
        ->type_name("PLACE");
    app.add_flag(
        "--view", a.view,
        "open a page in the browser that shows the board and drives it: step, back, registers, UARTs, "
        "faults, another image (--board; docs/view.md)");
    exec::InstrumentOptions& i = o.instruments;
    app.add_option(
           "--watch", i.watches,
           "variable, register or 0xADDRESS of data space, perhaps :BYTES, perhaps /r, /w (default) or "
           "/rw: ends the run after an instruction that touches it; repeatable, as --stop-at")
        ->allow_extra_args(false);
    app.add_option(
           "--trace", i.trace,
           "FILE that gets every instruction on a line: cycle, address, symbol, source line, text, and "
           "what it changed")
        ->type_name("FILE");
    app.add_option("--trace-range", i.trace_ranges,
                   "only instructions of this function, or of 0xFIRST..0xLAST; repeatable")
        ->allow_extra_args(false);
    app.add_option("--trace-from", i.trace_from, "only from this simulated second on")
        ->check(seconds_between(0.0, kLongestRun))
        ->type_name("TIME");
    app.add_option("--trace-to", i.trace_to, "only before this simulated second")
        ->check(seconds_between(0.0, kLongestRun))
        ->type_name("TIME");
    app.add_flag("--stats", i.stats,
                 "cycles of each function, the deepest stack, and reads of RAM that nothing had written");
    app.add_option(
           "--callgrind", i.callgrind,
           "FILE for cycles by instruction, line and call, as callgrind_annotate and KCachegrind read "
           "them")
        ->type_name("FILE");
    app.add_option("--coverage", i.coverage, "FILE for the lines that ran, as genhtml (lcov) reads them")
        ->type_name("FILE");
    app.add_option("--sources", i.sources, "folder in which --coverage gives the source files");
    app.add_option("--uart1", o.uart[0], "- (stdin and stdout), pty, tcp:PORT (on 127.0.0.1) or script:FILE");
    app.add_option("--uart2", o.uart[1], "the same for the second UART");
    app.add_option("--baud", a.baud,
                   "rate of the bench's ends, 8N1 (115200; rab board 57600; tam board 57600 and 9600)")
        ->check(number_between(kSlowestBaud, kFastestBaud));
    app.add_option("--uart1-baud", a.uart_baud[0], "rate of the end of the first UART alone")
        ->check(number_between(kSlowestBaud, kFastestBaud));
    app.add_option("--uart2-baud", a.uart_baud[1], "the same for the second UART")
        ->check(number_between(kSlowestBaud, kFastestBaud));
    app.add_option(
           "--uart-start", o.uart_start,
           "when standard input is offered, in simulated seconds; without it: once the chip's receiver has "
           "been on for 3 s without a reset")
        ->check(seconds_between(0.0, kLongestRun))
        ->type_name("TIME");
    app.add_option("--i2c", o.i2c,
                   "script:FILE, a bus master for I2C module 1 of targets that are slaves (an AVR alone is "
                   "one): lines `<time_s> w "
                   "<0xADDR> <hex bytes>` or `<time_s> r <0xADDR> <register or -> <count>`");
    app.add_option("--i2c-device", o.i2c_devices,
                   "on the bus of a target that is its master, repeatable: ground (0x60), turret (0x61), "
                   "lsm330 (0x1E, 0x6A) or rab=IMAGE (a range-and-bearing board with its firmware); @0xADDR "
                   "after it for another "
                   "address")
        ->allow_extra_args(false);
    app.add_option("--i2c-clock", o.i2c_master.clock_hertz, "its SCL in Hz")
        ->check(number_between(kSlowestI2c, kFastestI2c))
        ->capture_default_str();
    app.add_flag("!--i2c-no-restart", o.i2c_master.repeated_start,
                 "its reads name the register and begin again after a STOP, without repeated START");
    app.add_option("--stimulus", o.stimulus,
                   "FILE of `<time_s> <signal> <value>`; `<time_s> reset 1` presses the reset button");
    app.add_option(
           "--reset-at", o.resets,
           "simulated seconds at which the reset button is pressed (a pulse on MCLR); may be given more "
           "than once. `kill -USR1` on this process presses it at once")
        ->check(seconds_between(0.0, kLongestRun))
        ->allow_extra_args(false)
        ->type_name("TIME");
    app.add_option(
           "--nvm", o.nvm,
           "FILE that keeps flash, EEPROM and configuration: read at the start, if it is there, in place "
           "of what IMAGE holds, and replaced at the end")
        ->type_name("FILE");
    app.add_flag("--list-signals", o.list_signals, "name the signals with units and ranges, and end");
    app.add_option("--log", o.bench.log_folder,
                   "folder for uart1.csv, uart2.csv, i2c.csv, pins.csv, board.log (rab) and "
                   "speaker.wav (pic)");
    app.add_flag("--json", o.json, "one JSON object on one line instead of text");
    app.add_flag(
        "--strict", o.strict,
        "status 1 if there is anything to warn of: a trap, a program that hangs, registers without a "
        "model, I2C addresses that nobody acknowledges");
    app.add_option("--seed", t.seed, "of the random streams")
        ->check(count_up_to(kMostSeeds))
        ->capture_default_str();
    app.add_option("--adc-noise", t.adc_noise_counts, "standard deviation in counts (board)")
        ->check(number_between(0.0, 1000.0))
        ->capture_default_str();
    app.add_option("--selector", t.selector, "initial position of the selector (pic)")
        ->check(whole_number_between(0, 15))
        ->capture_default_str();
    app.add_option("--camera", t.camera_picture,
                   "PGM or PPM picture that the camera looks at (pic; without it a test pattern)")
        ->type_name("FILE");
    app.add_option("--camera-model", t.camera, "camera on the board: po3030k, po6030k, po8030d or none (pic)")
        ->check(one_of({"po3030k", "po6030k", "po8030d", "none"}))
        ->capture_default_str();
    app.add_flag("--camera-turned", t.camera_turned,
                 "the camera lies on its side, as the PO3030K of early boards (pic)");
    app.add_option(
           "--board-revision", a.revision,
           "of the main board (pic): 1.2, analogue accelerometer, or 1.3, LSM330 on its bus, battery at "
           "AN7")
        ->check(one_of({"1.2", "1.3"}))
        ->capture_default_str();
    app.add_option("--errata", a.errata,
                   "what revision B0 of the dsPIC30F6014A does otherwise than its manuals (docs/fidelity.md)")
        ->delimiter(',')
        ->check(one_of({dspic::kErratumNames.begin(), dspic::kErratumNames.end()}));
    app.add_option("--crystal", a.crystal_hertz,
                   "in Hz (7372800; of the dsPIC33F 4000000, of the AVR 16000000)")
        ->check(number_between(kSlowestCrystal, kFastestCrystal));
    app.add_option("--ppm", t.chip.ppm, "error of the crystal")
        ->check(number_between(-kWorstCrystal, kWorstCrystal))
        ->capture_default_str();
    app.add_option("--fosc", a.fosc,
                   "oscillator configuration in force: robot (dsPIC30F: XT, PLL x8; dsPIC33F: the image's), "
                   "image, or "
                   "0xWORD")
        ->capture_default_str();
    app.add_option("--fuses", a.fuses,
                   "fuse bytes of an AVR, 0xLOW,0xHIGH,0xEXTENDED[,0xLOCK], in place of the image's")
        ->type_name("BYTES");
    auto* realtime =
        app.add_flag("--realtime", a.realtime,
                     "pace by the wall clock (default if a pty, TCP or a terminal is at an end)");
    app.add_flag("--no-realtime", a.unpaced, "never pace")->excludes(realtime);
    declare_log_options(app, a.log);
    app.add_flag("!--no-skip", t.skip_idle, "execute every turn of busy-wait loops");
    app.add_flag("--no-translate", a.interpret,
                 "interpret every instruction of the chips (default: hot code is translated)");
}

/// Its run is one of `puckloop run --view`, of a scenario with this board alone.
[[noreturn]] void view_board(const Command& command, const ExecArguments& a) {
    const std::vector<std::string>& taken = options_with_view();
    for (const std::string& option : command.given())
        if (std::find(taken.begin(), taken.end(), option) == taken.end())
            throw InputError("", option, "does not go with --view",
                             "the page, or a scenario with `puckloop run --view`");
    const std::filesystem::path scenario = write_board_scenario(a.options, a.revision, a.errata);
    fmt::print(stderr, "puckloop: {} has the board's scenario\n", scenario.string());
    become_puckloop({"run", scenario.string(), "--view"});
}

}  // namespace

void declare_exec(Command& app, int& status) {
    Command* command = app.add_subcommand("exec", about("exec"));
    const auto arguments = std::make_shared<ExecArguments>();
    describe(*command, *arguments);
    command->footer("Examples:\n"
                    "  puckloop exec my.hex --uart1 - --seconds 2\n"
                    "  puckloop exec --board pic BTcom_default.hex --uart1 pty --realtime\n"
                    "  puckloop exec --mcu atmega1284p my.elf --stop-at main --json");
    command->callback([command, arguments, &status] {
        ExecArguments& a = *arguments;
        a.options.image = image_named(a.options.image);
        if (a.options.bench.mcu.empty() && a.options.bench.board.empty())
            a.options.bench.board = guess_board(a.options.image);
        start_log("exec", a.log);
        if (a.interpret) chip::set_translation(false);
        exec::BenchOptions& bench = a.options.bench;
        if (command->count("--selector") > 0 && bench.board != "pic")
            throw InputError("", "--selector",
                             fmt::format("{} has no selector", bench.board.empty() ? bench.mcu : bench.board),
                             "--board pic");
        for (const char* option : {"--camera", "--camera-model", "--camera-turned"})
            if (command->count(option) > 0 && bench.board != "pic")
                throw InputError(
                    "", option,
                    fmt::format("{} has no camera", bench.board.empty() ? bench.mcu : bench.board),
                    "--board pic");
        if (command->count("--board-revision") > 0 && bench.board != "pic")
            throw InputError(
                "", "--board-revision",
                fmt::format("of {} there is one revision", bench.board.empty() ? bench.mcu : bench.board),
                "--board pic");
        bench.target.revision = *pic::revision_of(a.revision);
        const exec::TargetDefaults defaults = exec::defaults_of(bench.mcu, bench.board);
        if (!a.errata.empty() && defaults.mcu != "dspic30f6014a")
            throw InputError("", "--errata", fmt::format("none of the {} is known", defaults.mcu),
                             "a dsPIC30F6014A");
        bench.target.chip.errata = dspic::errata_named(a.errata);
        bench.target.chip.crystal_hertz = a.crystal_hertz.value_or(defaults.crystal_hertz);
        const bool is_avr = defaults.mcu.starts_with("atmega");
        if (!is_avr && !a.fuses.empty())
            throw InputError("", "--fuses", fmt::format("the {} has none", defaults.mcu), "an AVR");
        if (is_avr && command->count("--fosc") > 0)
            throw InputError("", "--fosc", fmt::format("the {} has no such word", defaults.mcu), "--fuses");
        if (!a.fuses.empty()) bench.target.fuses = fuse_bytes(a.fuses);
        bench.target.chip.fosc = fosc_word(a.fosc, defaults.fosc);
        for (std::size_t unit = 0; unit < bench.baud.size(); ++unit)
            bench.baud[unit] = a.uart_baud[unit].value_or(a.baud.value_or(defaults.baud[unit]));
        if (!bench.log_folder.empty()) {
            bench.target.log = bench.log_folder + "/board.log";
            bench.target.camera_log = bench.log_folder + "/camera.csv";
            bench.target.rab_log = bench.log_folder + "/rab.log";
        }
        if (a.view) view_board(*command, a);
        if (a.realtime || a.unpaced) a.options.realtime = a.realtime;
        status = exec::run_exec(a.options);
    });
}

}  // namespace puckloop::tools
