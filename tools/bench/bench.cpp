// `puckloop bench`: performance figures, each measured beside a reference that the same machine runs in turn.

#include "tools/bench/bench.h"
#include "base/error.h"
#include "benchmark/cases.h"
#include "emu/chip/translate/translation_switch.h"
#include "tools/bench/bluetooth.h"
#include "tools/bench/density.h"
#include "tools/bench/network.h"
#include "tools/bench/rab.h"
#include "tools/bench/sound.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

constexpr int kMostThreads = 16, kMostRounds = 100, kMostRobots = 1000;

struct BenchCommandOptions {
    BenchOptions bench;
    bool json = false;
};

void run_bench(const BenchCommandOptions& options) {
    if (options.bench.interpret) chip::set_translation(false);
    if (const std::filesystem::path file = options.bench.scenario;
        !file.empty() && !std::filesystem::is_regular_file(file))
        throw InputError(file.string(), "--scenario", "no such file", "a scenario's TOML file");
    const OtherLoadMeter meter;
    const std::vector<Figure> figures = measure_cases(options.bench);
    fmt::print("{}",
               options.json ? figures_json(figures, meter.read()) : figures_table(figures, meter.read()));
}

}  // namespace

void declare_bench(Command& app, int& status) {
    Command* command = app.add_subcommand("bench", about("bench"));
    auto options = std::make_shared<BenchCommandOptions>();
    BenchOptions& bench = options->bench;
    command
        ->add_option("--scenario", bench.scenario,
                     "scenario to time in the case scenario (default scenarios/hello.toml)")
        ->type_name("SCENARIO");
    command->add_option("--image", bench.image, "firmware image to run on the bare chip as well")
        ->type_name("IMAGE");
    command
        ->add_option("--case", bench.cases,
                     "what to measure (repeatable; default core and scenario; docs/bench.md):" +
                         bench_cases_help())
        ->allow_extra_args(false)
        ->check(one_of(bench_cases()));
    command
        ->add_option("--rab-image", bench.rab_image,
                     "firmware of range-and-bearing boards (default: the project's)")
        ->type_name("IMAGE");
    command
        ->add_option("--peer", bench.peer,
                     "another build of puckloop, which runs the same in turn; ratios are this build / peer")
        ->type_name("PROGRAM");
    command
        ->add_option("--program", bench.program,
                     "control program for original images in the case lab20, a word of its command line each "
                     "time: --program ./controller --program=-c --program lab.argos")
        ->allow_extra_args(false)
        ->type_name("WORD");
    command->add_option("--robots", bench.robots, "how many wander (default 1 10 100)")
        ->check(whole_number_between(1, kMostRobots))
        ->type_name("N");
    command->add_option("--threads", bench.threads, "of runs in one process (default: each build's own)")
        ->check(whole_number_between(1, kMostThreads))
        ->type_name("N");
    command
        ->add_option("--duration", bench.simulated_s,
                     "simulated seconds of each run of a scenario with one robot (default 20); of dearer "
                     "runs a fixed share")
        ->check(positive_number())
        ->type_name("S");
    command->add_option("--rounds", bench.rounds, "measurements of each figure (default 5)")
        ->check(whole_number_between(1, kMostRounds))
        ->type_name("N");
    command->add_flag(
        "--no-translate", bench.interpret,
        "this build interprets every instruction of the chips (default: hot code is translated)");
    command->add_flag("--json", options->json, "print JSON");
    declare_bench_rab(*command, status);
    declare_bench_sound(*command, status);
    declare_bench_bluetooth(*command, status);
    declare_bench_network(*command, status);
    declare_bench_density(*command, status);
    command->callback([options, command, &status] {
        if (command->subcommand_given()) return;
        run_bench(*options);
        status = 0;
    });
}

}  // namespace puckloop::tools
