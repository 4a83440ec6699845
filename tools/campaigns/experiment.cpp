// puckloop experiment: programs, conditions and seeds as runs, and what their scores show (docs/swarm.md).

#include "base/error.h"
#include "base/plain_text.h"
#include "campaigns/experiment/again.h"
#include "campaigns/experiment/conduct.h"
#include "tools/campaigns/campaigns.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/cli/time_check.h"
#include "tools/files/scenario_name.h"

#include <fmt/format.h>

#include <memory>

namespace puckloop::tools {

namespace {

struct ExperimentCommandOptions {
    swarm::ExperimentOptions experiment;
    jobs::WorkerTask share;
    bool worker = false;
    int again = 0;  // number of a run; 0: none
};

constexpr int kMostExperimentSeeds = 100'000;
constexpr double kLongestExperimentRun = 2'592'000;  // s
constexpr int kMostExperimentJobs = 256, kMostExperimentTasks = 10'000, kLastRun = 2'000'000'000;

/// Status 1 if the run is not what it was.
int run_again(const ExperimentCommandOptions& options) {
    const swarm::Findings findings = swarm::read_findings(options.experiment.file);
    const std::filesystem::path out = options.experiment.out.empty()
                                          ? findings.out / "replay" / std::to_string(options.again)
                                          : options.experiment.out;
    const swarm::RunResult now = swarm::run_again(findings, options.again, out);
    const swarm::RunResult& before = findings.results.at(options.again);
    fmt::print("run {}: {}, trace {}\nresults in {}\n", options.again,
               !now.failed.empty() ? "failed: " + plain_text(now.failed, kLongestMessage)
               : now.score         ? fmt::format("score {:g}", *now.score)
                                   : "no score",
               now.trace, plain_text(out.string(), kLongestMessage));
    if (now.trace == before.trace) return 0;
    fmt::print(stderr, "puckloop: run {} is not what it was in the experiment\n", options.again);
    return 1;
}

/// Status 1 if a run failed.
int conduct(const ExperimentCommandOptions& options) {
    if (options.experiment.file.empty())
        throw InputError("", "experiment", "nothing given", "an experiment file (docs/swarm.md)");
    if (options.again > 0) {
        const auto& other = options.experiment;
        if (other.fresh || other.slurm || other.jobs != 0 || !other.against.empty() ||
            other.changes.seeds != 0 || other.changes.duration != 0)
            throw InputError("", "--again", "goes with --out alone", "--again N, --out DIR");
        return run_again(options);
    }
    if (!options.worker) return swarm::run_experiment(options.experiment) ? 0 : 1;
    swarm::work(options.experiment, options.share);
    return 0;
}

}  // namespace

void declare_experiment(Command& app, int& status) {
    auto options = std::make_shared<ExperimentCommandOptions>();
    Command* command = app.add_subcommand("experiment", about("experiment"));
    auto& experiment = options->experiment;
    command
        ->add_option("file", experiment.file,
                     "experiment file (docs/swarm.md); with --again: a results folder")
        ->type_name("FILE");
    command->add_option("--out", experiment.out, "folder for the results (default: out/<name of the file>)")
        ->check(not_empty())
        ->type_name("DIR");
    command->add_option("--seeds", experiment.changes.seeds, "seeds 1 to N, in place of those of the file")
        ->check(whole_number_between(1, kMostExperimentSeeds))
        ->type_name("N");
    command
        ->add_option("--duration", experiment.changes.duration,
                     "simulated time of each run, in place of the file's")
        ->check(seconds_between(1e-3, kLongestExperimentRun));
    command->add_option("--jobs,-j", experiment.jobs, "runs at a time on this machine (default: its cores)")
        ->check(whole_number_between(1, kMostExperimentJobs))
        ->type_name("N");
    command
        ->add_option(
            "--against", experiment.against,
            "CSV file with the columns program and score, condition if there are several: scores of real "
            "robots or of another model, set beside these")
        ->check(not_empty())
        ->type_name("CSV");
    command->add_flag("--slurm", experiment.slurm, "carry out the runs as job arrays of a Slurm cluster");
    command->add_option("--tasks", experiment.tasks, "with --slurm: tasks of an array")
        ->check(whole_number_between(1, kMostExperimentTasks))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag("--fresh", experiment.fresh, "drop the results that are in the folder and begin again");
    command
        ->add_option("--again", options->again,
                     "carry out one run of a results folder once more, with all files of a run "
                     "(into FILE/replay/N)")
        ->check(whole_number_between(1, kLastRun))
        ->type_name("N");
    // How an experiment starts its workers.
    command->add_flag("--worker", options->worker)->group("");
    command->add_option("--cases", options->share.jobs)->group("");
    command->add_option("--results", options->share.results)->group("");
    command->add_option("--task", options->share.task)
        ->check(whole_number_between(0, kMostExperimentTasks))
        ->group("");
    command->footer("Examples:\n"
                    "  puckloop experiment scenarios/experiments/aggregation.toml\n"
                    "  puckloop experiment aggregation --seeds 2 --duration 5s --out out/short\n"
                    "  puckloop experiment scenarios/experiments/aggregation.toml --against robots.csv\n"
                    "  puckloop experiment out/aggregation --again 12");
    command->callback([options, &status] {
        if (options->again == 0) options->experiment.file = experiment_named(options->experiment.file);
        options->share.tasks = options->experiment.tasks;
        status = conduct(*options);
    });
}

}  // namespace puckloop::tools
