// puckloop gap power: how many measured runs a comparison of swarms needs.

#include "gap/mission/power.h"
#include "base/error.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/gap/folders.h"
#include "tools/gap/subcommands.h"

#include <fmt/format.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>

namespace puckloop::tools {

namespace {

struct PowerOptions {
    std::filesystem::path simulated, svg, csv;
    gap::mission::PowerRequest request;
};

void show_power(PowerOptions& options) {
    auto& runs = options.request.runs;
    if (!std::is_sorted(runs.begin(), runs.end(), std::less_equal<>()))
        throw InputError("", "--runs", "the numbers do not rise", "such as 4 8 16");
    const auto simulated = gap::mission::read_mission_runs(options.simulated);
    options.request.progress = [](std::size_t done, std::size_t of) {
        if (::isatty(STDERR_FILENO)) fmt::print(stderr, "\r{} of {}{}", done, of, done == of ? "\n" : "");
    };
    const auto power = gap::mission::power_of(simulated, options.request);
    const std::pair<const std::filesystem::path&, std::string> files[] = {
        {options.svg, gap::mission::power_svg(power)}, {options.csv, gap::mission::power_csv(power)}};
    for (const auto& [file, text] : files) {
        if (file.empty()) continue;
        write_beside(file, text);
        put_in_place(file);
    }
    fmt::print("{}", gap::mission::power_text(power));
}

}  // namespace

void declare_gap_power(Command& gap, int& status) {
    constexpr int kMostRuns = 10000, kMostCases = 100000;
    constexpr double kMostShare = 10.0;
    Command* command = gap.add_subcommand(
        "power", "How many measured runs of a swarm `gap mission` needs to name each of an experiment's "
                 "effects");
    auto options = std::make_shared<PowerOptions>();
    command
        ->add_option("simulated", options->simulated,
                     "results of `puckloop experiment` with keep = true, at least four runs of each program "
                     "and condition")
        ->type_name("DIR")
        ->check(not_empty())
        ->required();
    command
        ->add_option("--runs", options->request.runs,
                     "measured runs of each program, rising (default: 4 8 16 32)")
        ->check(whole_number_between(2, kMostRuns))
        ->type_name("N...");
    command->add_option("--cases", options->request.cases, "drawn for each of them and each effect (40)")
        ->check(whole_number_between(1, kMostCases))
        ->type_name("N");
    command
        ->add_option("--share", options->request.share,
                     "of what a condition changes that is hidden (1: all of it)")
        ->check(number_between(-kMostShare, kMostShare))
        ->type_name("X");
    command->add_option("--seed", options->request.seed, "of the draws (1)")->type_name("N");
    command->add_option("--svg", options->svg, "the curves as a picture")
        ->type_name("FILE")
        ->check(not_empty());
    command->add_option("--csv", options->csv, "the counts as rows")->type_name("FILE")->check(not_empty());
    command->callback([options, &status] {
        status = 0;
        show_power(*options);
    });
}

}  // namespace puckloop::tools
