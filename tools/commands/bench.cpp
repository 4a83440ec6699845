// `puckloop bench`: performance figures, each measured beside a reference that the same machine runs in turn.

#include "base/error.h"
#include "cosim/interrupt.h"
#include "emu/dspic/core_bench.h"
#include "tools/bench/reference.h"
#include "tools/commands.h"
#include "tools/commands/bench_rab.h"
#include "tools/commands/number_checks.h"
#include "tools/run/run_scenario.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <memory>
#include <vector>

namespace puckloop::tools {

namespace {

/// Where this program was built; `bench` works from any folder.
const std::filesystem::path kHello = PUCKLOOP_SCENARIOS "/hello.toml";

struct Options {
    std::filesystem::path scenario;  ///< empty: the project's hello.toml
    std::string image;
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

double real_time_factor(const Options& options, bool in_process, const std::filesystem::path& folder) {
    RunRequest request;
    request.scenario = options.scenario.empty() ? kHello : options.scenario;
    request.out = folder;
    request.duration = options.simulated_s;
    request.in_process = in_process;
    const cosim::InterruptGuard interrupt;
    const cosim::Outcome outcome = run_scenario(set_up(request), request, {}, interrupt.flag());
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

std::vector<Figure> measure_all(const Options& options) {
    const auto millions = [](const dspic::CoreBenchResult& result) {
        return result.instructions_per_second() * 1e-6;
    };
    std::vector<Figure> figures;
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
    const Scratch scratch;
    const std::string name = options.scenario.empty() ? "hello.toml" : options.scenario.filename().string();
    figures.push_back(measure(name + ", one process", "x real time", options,
                              [&] { return real_time_factor(options, true, scratch.path()); }));
    figures.push_back(measure(name + ", a process a node", "x real time", options,
                              [&] { return real_time_factor(options, false, scratch.path()); }));
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

void declare_bench(CLI::App& app, int& status) {
    CLI::App* command =
        app.add_subcommand("bench", "measure the core and a scenario against a reference of this machine");
    auto options = std::make_shared<Options>();
    command->add_option("--scenario", options->scenario, "scenario to time (default scenarios/hello.toml)")
        ->type_name("SCENARIO");
    command->add_option("--image", options->image, "firmware image to run on the bare chip as well")
        ->type_name("IMAGE");
    command->add_option("--duration", options->simulated_s, "simulated seconds of each run of the scenario")
        ->check(positive_number())
        ->type_name("S");
    command->add_option("--rounds", options->rounds, "measurements of each figure")
        ->check(CLI::Range(1, 100))
        ->type_name("N");
    command->add_flag("--json", options->json, "print JSON");
    declare_bench_rab(*command, status);
    command->callback([options, command, &status] {
        if (!command->get_subcommands().empty()) return;
        print(measure_all(*options), options->json);
        status = 0;
    });
}

}  // namespace puckloop::tools
