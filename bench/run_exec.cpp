// `puckloop exec`: from options to a bench, through the run, to the report.

#include "base/error.h"
#include "base/logs/log.h"
#include "bench/debug_run.h"
#include "bench/exec_report.h"
#include "bench/options.h"
#include "emu/board/nvm_file.h"
#include "ends/script_end.h"
#include "ends/text_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace puckloop::exec {

namespace {

/// Budget of a run that nobody gave one, unless somebody live is at a UART.
constexpr double kDefaultSeconds = 60.0;
constexpr std::string_view kScript = "script:";

std::atomic<bool> g_interrupted{false};

void on_interrupt(int) {
    g_interrupted = true;
}

std::atomic<bool> g_reset{false};

void on_reset(int) {
    g_reset = true;
}

std::unique_ptr<UartEnd> make_end(const UartSpec& spec, int unit, const ExecOptions& options) {
    const double baud = options.bench.baud[static_cast<std::size_t>(unit - 1)];
    const LiveOptions live{fmt::format("uart{}", unit), static_cast<cosim::Time>(std::llround(1e12 / baud)),
                           options.realtime.value_or(true)};
    switch (spec.kind) {
    case UartSpec::Kind::Nothing:
        return nullptr;
    case UartSpec::Kind::Stdio: {
        StdioOptions stdio;
        if (options.uart_start) stdio.start = cosim::from_seconds(*options.uart_start);
        stdio.live = options.realtime.value_or(false);
        return make_stdio_end(stdio);
    }
    case UartSpec::Kind::Pty:
        return make_pty_end(live);
    case UartSpec::Kind::Tcp:
        return make_tcp_end(spec.port, live);
    case UartSpec::Kind::Script:
        return std::make_unique<ScriptEnd>(parse_uart_script(spec.file, read_text_file(spec.file)));
    }
    return nullptr;
}

UartSpec spec_of(std::string_view option, const std::optional<std::string>& text) {
    return text ? parse_uart_spec(option, *text) : UartSpec{};
}

/// The script is checked even where it cannot be used, so that its own mistakes are reported first.
std::vector<I2cScriptLine> i2c_script(const std::string& text, const Target& target) {
    if (text.empty()) return {};
    if (!text.starts_with(kScript) || text.size() == kScript.size())
        throw InputError("", "--i2c", fmt::format("'{}' is not a bus master's script", text), "script:FILE");
    const std::string file = text.substr(kScript.size());
    std::vector<I2cScriptLine> script = parse_i2c_script(file, read_text_file(file));
    if (!target.is_i2c_slave())
        throw InputError("", "--i2c", "this target is the master of its bus and cannot be addressed",
                         "a board that is an I2C slave");
    return script;
}

/// With the devices on the bus of the target, which must be its master.
BenchOptions bench_options(const ExecOptions& options) {
    BenchOptions bench = options.bench;
    bench.record = !options.gdb.empty();
    std::vector<std::string> devices = options.i2c_devices;
    if (bench.target.revision == pic::Revision::Rev13 &&
        std::ranges::find(devices, "lsm330") == devices.end())
        devices.emplace_back("lsm330");
    bench.target.i2c_devices = parse_i2c_devices(devices);
    if (bench.target.i2c_devices.empty()) return bench;
    if (bench.board == "rab")
        throw InputError("", "--i2c-device", "the rab board is a slave of its bus, not its master",
                         "a board that is an I2C master, or --i2c script:FILE");
    if (bench.board == "tam")
        throw InputError("", "--i2c-device", "the tam board's bus has its LED driver and nothing else",
                         "a chip or board with an open bus");
    if (!options.i2c.empty())
        throw InputError("", "--i2c-device", "an --i2c script speaks to the target on the same bus",
                         "one of the two");
    return bench;
}

cosim::Time budget_of(const ExecOptions& options, Bench& bench, bool live) {
    if (options.cycles) return bench.target().clock().time_of(*options.cycles);
    if (options.seconds) return cosim::from_seconds(*options.seconds);
    return live ? cosim::kNever : cosim::from_seconds(kDefaultSeconds);
}

/// Somebody who sits at a live end does not wait for the summary: a hang is reported when it is found.
class HangNotice {
  public:
    explicit HangNotice(Bench& bench) : bench_(bench) {}
    void look() {
        if (reported_ || bench_.now() < next_) return;
        next_ = bench_.now() + kPeriod;
        const std::optional<std::string> hang = bench_.target().hang();
        if (!hang) return;
        reported_ = true;
        std::fprintf(stderr, "warning: %s\n", hang->c_str());
    }

  private:
    static constexpr cosim::Time kPeriod = 2 * cosim::kSecond;
    Bench& bench_;
    cosim::Time next_ = kPeriod;
    bool reported_ = false;
};

std::string symbol_at(const image::Image& image, std::uint32_t pc) {
    for (const auto& [name, symbol] : image.symbols)
        if (symbol.space == image::Space::Program && symbol.address == pc) return name;
    return {};
}

}  // namespace

Surroundings surround(Bench& bench, const ExecOptions& options) {
    if (!options.stimulus.empty())
        bench.stimulate(
            parse_stimulus(options.stimulus, read_text_file(options.stimulus), bench.target().signals()));
    if (!options.i2c.empty()) bench.master(i2c_script(options.i2c, bench.target()), options.i2c_master);
    const UartSpec specs[] = {spec_of("--uart1", options.uart[0]), spec_of("--uart2", options.uart[1])};
    if (specs[0].kind == UartSpec::Kind::Stdio && specs[1].kind == UartSpec::Kind::Stdio)
        throw InputError("", "--uart2", "standard input and output are already at uart1", "another end");
    Surroundings found;
    for (int unit = 1; unit <= 2; ++unit) {
        const UartSpec& spec = specs[unit - 1];
        std::unique_ptr<UartEnd> end = make_end(spec, unit, options);
        if (!end) continue;
        found.live |= end->live();
        log::info("uart{}: {}{}", unit, *options.uart[static_cast<std::size_t>(unit - 1)],
                  end->live() ? ", live: paced by the wall clock" : "");
        found.stdio |= spec.kind == UartSpec::Kind::Stdio;
        if (!end->announcement().empty()) {
            std::fprintf(stderr, "uart%d: %s\n", unit, end->announcement().c_str());
            std::fflush(stderr);
        }
        bench.uart(unit).attach(std::move(end));
    }
    std::vector<StimulusLine> resets;
    for (const double seconds : options.resets)
        resets.push_back({cosim::from_seconds(seconds), StimulusLine::kReset, 1.0});
    bench.stimulate(resets);
    return found;
}

int run_exec(const ExecOptions& options) {
    if (!options.gdb.empty() && options.instruments.any())
        throw InputError("", "--gdb", "a debugger and --trace, --watch or --stats do not go together",
                         "one of them");
    Bench bench(bench_options(options));
    if (options.list_signals) {
        const auto signals = bench.target().signals();
        std::fputs((options.json ? signals_json(signals) : signals_text(signals)).c_str(), stdout);
        return 0;
    }
    if (options.image.empty()) throw InputError("", "IMAGE", "missing", "a HEX, ELF or COFF file");
    const image::Image image =
        bench.target().read_image(options.image, defaults_of(options.bench.mcu, options.bench.board).mcu);
    const LineLookup lines = [&target = bench.target()](const std::string& file, std::uint32_t line) {
        return target.addresses_of(file, line);
    };
    std::vector<StopAddress> stops;
    for (const std::string& text : options.stop_at) {
        for (const StopAddress& stop : resolve_stop(text, image, lines)) {
            stops.push_back(stop);
            if (options.gdb.empty()) bench.target().stop_at(stop.pc);
        }
    }
    const auto [live, stdio] = surround(bench, options);
    std::optional<board::NvmFile> nvm;
    if (!options.nvm.empty())
        nvm.emplace(options.nvm, defaults_of(options.bench.mcu, options.bench.board).mcu, image);
    if (nvm)
        bench.target().load_kept(image, *nvm);
    else
        bench.target().load(image);

    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    std::signal(SIGPIPE, SIG_IGN);
    std::signal(SIGUSR1, on_reset);
    HangNotice notice(bench);
    const bool paced = options.realtime.value_or(live);
    bench.interrupted = [&] {
        if (paced) notice.look();
        if (g_reset.exchange(false)) {
            bench.press_reset();
            std::fprintf(stderr, "reset button pressed at %.3f s\n", cosim::to_seconds(bench.now()));
        }
        return g_interrupted.load();
    };
    std::optional<DebugRun> debugger;
    if (!options.gdb.empty()) {
        debugger.emplace(bench, options.gdb);
        for (const StopAddress& stop : stops)
            debugger->end_at(stop.pc);
        std::fprintf(stderr, "gdb: %s\n", debugger->address().c_str());
        std::fflush(stderr);
    }
    std::optional<BenchInstruments> instruments;
    if (options.instruments.any()) instruments.emplace(options.instruments, bench.target(), image);
    const cosim::Time budget = budget_of(options, bench, live || debugger);
    log::info("target {}{}, budget {}", options.bench.board, options.bench.mcu,
              budget == cosim::kNever ? "none" : fmt::format("{:.6f} s", cosim::to_seconds(budget)));
    const auto began = std::chrono::steady_clock::now();
    if (paced) bench.pace_by_wall_clock();
    ExecOutcome outcome;
    outcome.end = debugger ? debugger->run(budget, paced) : bench.run_until(budget);
    const bool stuck = bench.master() != nullptr && bench.master()->report().stuck_since;
    bench.finish();
    if (nvm) bench.target().save_memory(*nvm);
    outcome.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    outcome.pc = bench.target().pc();
    outcome.symbol = symbol_at(image, outcome.pc);
    outcome.line = bench.target().source_line(outcome.pc);
    outcome.stopped = outcome.end == Bench::End::Interrupted ? "interrupted" : "budget";
    if (instruments) {
        instruments->finish();
        outcome.stats_text = instruments->text();
        outcome.stats_json = instruments->json();
    }
    if (outcome.end == Bench::End::Address && instruments && !instruments->watched().empty())
        outcome.stopped = instruments->watched();
    else if (outcome.end == Bench::End::Address)
        for (const StopAddress& stop : stops)
            if (stop.pc == outcome.pc) outcome.stopped = stop.name;
    log::info("ended after {:.2f} s at pc {:#x}: {}", outcome.wall_s, outcome.pc, outcome.stopped);
    outcome.success =
        !stuck &&
        (outcome.end == Bench::End::Address ||
         (outcome.end == Bench::End::Time && options.stop_at.empty() && options.instruments.watches.empty()));
    if (options.strict && outcome.success) {
        std::vector<std::string> warnings = warnings_of(bench);
        if (instruments && !instruments->warning().empty()) warnings.push_back(instruments->warning());
        outcome.success = warnings.empty();
        if (!warnings.empty()) outcome.failure = "with --strict a warning is a failure: " + warnings.front();
    }

    if (debugger) debugger->on_exit(outcome.success ? 0 : 1);
    // Standard output belongs to the UART when `-` stands there; JSON is then its last line.
    if (options.json)
        std::printf("%s%s\n", stdio ? "\n" : "", json_report(bench, image, outcome).c_str());
    else
        std::fputs(text_report(bench, outcome).c_str(), stdio ? stderr : stdout);
    if (std::fflush(stdout) != 0) throw RunError("standard output: cannot be written");
    return outcome.success ? 0 : 1;
}

}  // namespace puckloop::exec
