// puckloop faults: campaigns of injected faults (docs/faults.md).

#include "base/error.h"
#include "base/plain_text.h"
#include "campaigns/engine/campaign.h"
#include "campaigns/engine/html.h"
#include "campaigns/engine/table.h"
#include "campaigns/engine/worker.h"
#include "tools/campaigns/campaigns.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"
#include "tools/cli/other_programs.h"
#include "tools/files/scenario_name.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

namespace puckloop::tools {

namespace {

struct FaultsOptions {
    faults::CampaignOptions campaign;
    faults::WorkerTask worker;
    std::filesystem::path folder, replay_out;
    int id = 0;
};

constexpr int kMostJobs = 256, kMostTasks = 10'000, kLastCase = 2'000'000'000;

void need(const std::filesystem::path& given, const char* place, const char* expected) {
    if (given.empty()) throw InputError("", place, "nothing given", expected);
}

/// Status 1 if the case is not what it was.
int replay(const FaultsOptions& options) {
    const faults::Results results = faults::read_results(options.folder);
    const std::filesystem::path out =
        options.replay_out.empty() ? results.out / "replay" / std::to_string(options.id) : options.replay_out;
    const faults::Verdict now = faults::replay(results, options.id, out);
    const auto before = std::find_if(results.results.begin(), results.results.end(),
                                     [&](const auto& result) { return result.one.id == options.id; });
    fmt::print("{}", faults::case_text(results, options.id));
    fmt::print("replayed: {}, trace {}\nresults in {}\n", faults::name_of(now.outcome), now.trace_sha256,
               plain_text(out.string(), kLongestMessage));
    if (now.outcome == before->verdict.outcome && now.trace_sha256 == before->verdict.trace_sha256) return 0;
    fmt::print(stderr, "puckloop: case {} is not what it was in the campaign\n", options.id);
    return 1;
}

void declare_campaign(Command& faults, const std::shared_ptr<FaultsOptions>& options) {
    Command* command = faults.add_subcommand(
        "campaign", "run every fault of a campaign file against its scenario, or what is left of them");
    auto& campaign = options->campaign;
    command->add_option("file", campaign.file, "campaign file (docs/faults.md)")->type_name("FILE");
    command->add_option("--out", campaign.out, "folder for the results (default: out/<name of the file>)")
        ->type_name("DIR");
    command->add_option("--jobs,-j", campaign.jobs, "worker processes on this machine (default: its cores)")
        ->check(whole_number_between(1, kMostJobs))
        ->type_name("N");
    command->add_flag("--slurm", campaign.slurm, "run the cases as job arrays of a Slurm cluster");
    command->add_option("--tasks", campaign.tasks, "with --slurm: tasks of an array")
        ->check(whole_number_between(1, kMostTasks))
        ->type_name("N")
        ->capture_default_str();
    command->add_flag(
        "!--no-snapshots", campaign.snapshots,
        "execute every case whole, none from a snapshot of the nominal run; the results are the same");
    command->add_flag("--fresh", campaign.fresh, "drop the results that are in the folder and begin again");
    command->callback([options] {
        need(options->campaign.file, "faults campaign", "a campaign file");
        options->campaign.file = campaign_named(options->campaign.file);
        faults::run_campaign(options->campaign);
    });
}

void declare_worker(Command& faults, const std::shared_ptr<FaultsOptions>& options) {
    Command* command = faults.add_subcommand("worker", "runs cases of a campaign; campaigns start it");
    command->group("");
    auto& worker = options->worker;
    command->add_option("file", worker.campaign);
    command->add_option("out", worker.out);
    command->add_option("--cases", worker.share.jobs);
    command->add_option("--results", worker.share.results);
    command->add_option("--task", worker.share.task)->check(whole_number_between(0, kMostTasks));
    command->add_option("--tasks", worker.share.tasks)->check(whole_number_between(1, kMostTasks));
    command->callback([options] { faults::work(options->worker); });
}

}  // namespace

void declare_faults(Command& app, int& status) {
    auto options = std::make_shared<FaultsOptions>();
    Command* command = app.add_subcommand("faults", about("faults"));
    command->require_subcommand();
    declare_campaign(*command, options);
    const auto add_folder = [&](Command* to) {
        to->add_option("folder", options->folder, "results folder of a campaign")->type_name("DIR");
    };
    Command* show = command->add_subcommand("show", "outcomes and findings of a campaign, or one case");
    add_folder(show);
    show->add_option("case", options->id, "a case's number")
        ->check(whole_number_between(1, kLastCase))
        ->type_name("CASE");
    show->callback([options] {
        need(options->folder, "faults show", "the results folder of a campaign");
        const faults::Results results = faults::read_results(options->folder);
        fmt::print("{}",
                   options->id == 0 ? faults::summary(results) : faults::case_text(results, options->id));
    });
    Command* again = command->add_subcommand("replay", "run one case again, with all files of a run");
    add_folder(again);
    again->add_option("case", options->id, "its number")
        ->check(whole_number_between(1, kLastCase))
        ->type_name("CASE");
    again->add_option("--out", options->replay_out, "folder for the run's results (default: DIR/replay/CASE)")
        ->type_name("DIR");
    again->callback([options, &status] {
        need(options->folder, "faults replay", "the results folder of a campaign");
        if (options->id == 0) throw InputError("", "faults replay", "no case given", "a case's number");
        status = replay(*options);
    });
    Command* report = command->add_subcommand("report", "write results.csv and report.html again");
    add_folder(report);
    report->callback([options] {
        need(options->folder, "faults report", "the results folder of a campaign");
        const faults::Results results = faults::read_results(options->folder);
        faults::write_table(results);
        faults::write_html(results);
        fmt::print("{}\n", plain_text((results.out / "report.html").string(), kLongestMessage));
    });
    declare_worker(*command, options);
}

}  // namespace puckloop::tools
