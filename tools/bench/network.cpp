// `puckloop bench network`: pause times of teams that talk by WiFi, beside what was published.

#include "tools/bench/network.h"
#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "base/files/shipped_files.h"
#include "base/files/text_file.h"
#include "reproductions/pause_times.h"
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

struct NetworkOptions {
    std::vector<int> robots;
    int runs = 10;
    double seconds = 27;
    std::filesystem::path firmware;
    std::vector<std::string> forwarder;
    std::string standard = "g";
    double rate = 0;
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/pause_times";
};

std::string seconds_since(std::chrono::steady_clock::time_point begin) {
    return fmt::format("{:.0f} s",
                       std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
}

std::vector<int> team_sizes(const NetworkOptions& options) {
    std::vector<int> sizes = options.robots;
    if (sizes.empty())
        for (int robots = kFewestInTeam; robots <= kMostInTeam; ++robots)
            sizes.push_back(robots);
    std::sort(sizes.begin(), sizes.end());
    sizes.erase(std::unique(sizes.begin(), sizes.end()), sizes.end());
    return sizes;
}

/// Words of the programs between UART2 and TCP.
std::vector<std::vector<std::string>> forwarders_of(const NetworkOptions& options) {
    if (options.forwarder.empty())
        return {{"puckloop-forward"}, {shipped_file("scenarios/programs/plain_forward.py").string()}};
    std::vector<std::string> words = options.forwarder;
    // A program by its path is found from the run's folder as well.
    if (words.front().find('/') != std::string::npos)
        words.front() = std::filesystem::absolute(words.front()).string();
    return {words};
}

TeamSpec team_of(const NetworkOptions& options) {
    TeamSpec spec;
    spec.folder = options.out / "run";
    spec.firmware = options.firmware.empty() ? shipped_image("network.hex") : options.firmware;
    if (spec.firmware.empty())
        throw InputError("", "bench network", "there is no network.hex beside this program",
                         "the firmware folder, or --firmware IMAGE");
    spec.standard = options.standard;
    spec.rate = options.rate;
    spec.seconds = options.seconds;
    return spec;
}

/// All runs of a size; what they gave is added to `csv`.
TeamPauses measure_team(const NetworkOptions& options, TeamSpec spec, const std::string& name,
                        std::string& csv) {
    const bool terminal = ::isatty(STDERR_FILENO) == 1;
    std::vector<Pause> pauses;
    for (int run = 0; run < options.runs; ++run) {
        if (terminal)
            fmt::print(stderr, "\r{}, {} robots, run {} of {} ", name, spec.robots, run + 1, options.runs);
        spec.seed = options.seed * 1000 + static_cast<std::uint64_t>(run);
        const std::vector<Pause> found = run_team(spec);
        pauses.insert(pauses.end(), found.begin(), found.end());
        csv += pauses_csv(name, spec.robots, run, found);
    }
    return summary_of(spec.robots, options.runs, pauses);
}

void run_network(const NetworkOptions& options, int& status) {
    TeamSpec spec = team_of(options);
    claim_folder(options.out, ".puckloop-bench", {"pauses.csv", "pauses.svg", "run"});
    const auto begin = std::chrono::steady_clock::now();
    std::string csv = pauses_csv_head();
    std::vector<PauseSeries> all;
    for (const std::vector<std::string>& forwarder : forwarders_of(options)) {
        spec.forwarder = forwarder;
        PauseSeries series{std::filesystem::path(forwarder.front()).filename().string()};
        for (const int robots : team_sizes(options)) {
            spec.robots = robots;
            series.teams.push_back(measure_team(options, spec, series.forwarder, csv));
        }
        fmt::print("{}", pause_table(series));
        all.push_back(std::move(series));
    }
    write_file(options.out / "pauses.csv", csv);
    write_file(options.out / "pauses.svg",
               pause_picture(all, fmt::format("802.11{}, {} runs of {:g} s for each size; boxes: quartiles, "
                                              "whiskers: 5 and 95 %",
                                              options.standard, options.runs, options.seconds)));
    fmt::print("took {}; {}\n", seconds_since(begin), (options.out / "pauses.svg").string());
    status = 0;
}

}  // namespace

void declare_bench_network(Command& bench, int& status) {
    Command* command = bench.add_subcommand(
        "network", "pause times of teams that talk by WiFi, beside the published ones (docs/network.md)");
    auto options = std::make_shared<NetworkOptions>();
    command->add_option("--robots", options->robots, "size of the team (repeatable; default 2 to 14)")
        ->allow_extra_args(false)
        ->check(whole_number_between(kFewestInTeam, kMostInTeam))
        ->type_name("N");
    command->add_option("--runs", options->runs, "of each size (default 10)")
        ->check(whole_number_between(1, 1000))
        ->type_name("N");
    command
        ->add_option(
            "--duration", options->seconds,
            "of a run (default 27): its first 4 s and last 3 s do not count, each robot sends every 5")
        ->check(number_between(12, 3600))
        ->type_name("S");
    command
        ->add_option("--firmware", options->firmware,
                     "image that at selector 10 sends to all over UART2 (default firmware/network)")
        ->type_name("IMAGE");
    command
        ->add_option("--forwarder", options->forwarder,
                     "program between UART2 and TCP, a word of its command line each time; --server "
                     "manager:7700 follows (default both: puckloop-forward, plain_forward.py)")
        ->allow_extra_args(false)
        ->type_name("WORD");
    command->add_option("--standard", options->standard, "of the radio: b or g (default g)")
        ->check(one_of({"b", "g"}));
    command
        ->add_option("--rate", options->rate,
                     "of frames to one station, one of the standard's (default: by the power that arrives)")
        ->check(number_between(1, 54))
        ->type_name("MBIT_S");
    command->add_option("--seed", options->seed, "of what is drawn")
        ->check(count_up_to(1'000'000'000))
        ->type_name("N");
    command->add_option("--out", options->out, "folder for results (default out/pause_times)")
        ->type_name("DIR");
    command->callback([options, &status] { run_network(*options, status); });
}

}  // namespace puckloop::tools
