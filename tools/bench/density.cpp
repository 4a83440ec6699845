// `puckloop bench density`: range and bearing among many robots, beside the published calibrations.

#include "tools/bench/density.h"
#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/shipped_files.h"
#include "base/files/text_file.h"
#include "reproductions/density/density.h"
#include "tools/bench/assignment.h"
#include "tools/cli/check.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tools {

namespace {

struct DensityOptions {
    std::vector<int> robots, bytes;
    std::vector<std::string> parameters;
    int runs = 0;  // 0: so many that each size has some forty robots
    DensitySpec spec;
    std::filesystem::path out = "out/density";
};

constexpr int kRobotsOfASize = 40;

/// What docs/rab.md advises for swarms.
const std::map<std::string, double> kForSwarms{{"ir.reach", 0.85}, {"ir.gain_share", 0.5}};

std::vector<int> sorted(std::vector<int> given, std::vector<int> otherwise) {
    if (given.empty()) given = std::move(otherwise);
    std::sort(given.begin(), given.end());
    given.erase(std::unique(given.begin(), given.end()), given.end());
    return given;
}

DensityRow measure_row(const DensityOptions& options, const std::string& setting, DensitySpec spec) {
    DensityRow row{setting, spec.robots, spec.bytes, options.runs};
    if (row.runs == 0) row.runs = std::max(1, kRobotsOfASize / spec.robots);
    for (int run = 0; run < row.runs; ++run) {
        if (::isatty(STDERR_FILENO) == 1)
            fmt::print(stderr, "\r{}: {} robots, {} bytes, run {} of {} ", setting, spec.robots, spec.bytes,
                       run + 1, row.runs);
        spec.seed = options.spec.seed * 1000 + static_cast<std::uint64_t>(run);
        row.density.add(run_density(spec));
    }
    return row;
}

void run_density_bench(DensityOptions& options, int& status) {
    DensitySpec spec = options.spec;
    if (spec.firmware.empty()) spec.firmware = shipped_image("rab.hex");
    if (spec.firmware.empty())
        throw InputError("", "bench density", "there is no rab.hex beside this program",
                         "the firmware folder, or --firmware IMAGE");
    claim_folder(options.out, ".puckloop-bench", {"density.csv", "density.svg", "run"});
    spec.folder = options.out / "run";
    const auto begin = std::chrono::steady_clock::now();
    const bool own = !options.parameters.empty();
    const auto set = own ? assignments_of(options.parameters) : kForSwarms;
    std::vector<DensityRow> rows;
    for (const bool changed : {false, true}) {
        spec.parameters = changed ? set : std::map<std::string, double>{};
        for (const int bytes : sorted(options.bytes, {1, 2, 4}))
            for (const int robots : sorted(options.robots, {2, 5, 10, 20})) {
                spec.bytes = bytes;
                spec.robots = robots;
                rows.push_back(measure_row(options, !changed ? "default" : own ? "set" : "for swarms", spec));
            }
    }
    fmt::print("{}", density_table(rows));
    write_file(options.out / "density.csv", density_csv(rows));
    write_file(options.out / "density.svg",
               density_picture(rows, fmt::format("{}, each sends every {:g} ms",
                                                 spec.firmware.filename().string(), spec.emit_ms)));
    fmt::print("took {:.0f} s; {}\n",
               std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(),
               (options.out / "density.svg").string());
    status = 0;
}

}  // namespace

void declare_bench_density(Command& bench, int& status) {
    constexpr int kMostRuns = 1000, kMostBytes = 4;
    constexpr double kShortest = 0.1, kLongest = 600;
    Command* command = bench.add_subcommand(
        "density",
        "range and bearing among 2 to 40 robots, by payload and distance, beside published calibrations "
        "(docs/rab.md)");
    auto options = std::make_shared<DensityOptions>();
    command->add_option("--robots", options->robots, "size of the team (repeatable; default 2, 5, 10 and 20)")
        ->allow_extra_args(false)
        ->check(whole_number_between(2, kMostOfDensity))
        ->type_name("N");
    command->add_option("--bytes", options->bytes, "of a payload (repeatable; default 1, 2 and 4)")
        ->allow_extra_args(false)
        ->check(whole_number_between(1, kMostBytes))
        ->type_name("N");
    command->add_option("--runs", options->runs, "of each (default: until some 40 robots have stood)")
        ->check(whole_number_between(1, kMostRuns))
        ->type_name("N");
    command->add_option("--duration", options->spec.seconds, "that counts of a run (default 1)")
        ->check(number_between(kShortest, kLongest))
        ->type_name("S");
    command
        ->add_option("--firmware", options->spec.firmware,
                     "image of the range-and-bearing boards (default firmware/rab)")
        ->type_name("IMAGE");
    command
        ->add_option(
            "--set", options->parameters,
            "physical parameter of the second half of the table (repeatable; default what docs/rab.md "
            "advises for swarms)")
        ->allow_extra_args(false)
        ->type_name("NAME=NUMBER");
    command->add_option("--seed", options->spec.seed, "of what is drawn")
        ->check(count_up_to(1'000'000'000))
        ->type_name("N");
    command->add_option("--out", options->out, "folder for results (default out/density)")->type_name("DIR");
    command->callback([options, &status] { run_density_bench(*options, status); });
}

}  // namespace puckloop::tools
