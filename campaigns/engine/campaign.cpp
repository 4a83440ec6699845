#include "campaigns/engine/campaign.h"

#include "base/error.h"
#include "base/files/claimed_folder.h"
#include "campaigns/engine/case_run.h"
#include "campaigns/engine/html.h"
#include "campaigns/engine/identity.h"
#include "campaigns/engine/table.h"
#include "campaigns/engine/worker.h"
#include "campaigns/jobs/folder_lock.h"
#include "campaigns/jobs/isolated.h"
#include "campaigns/jobs/pool.h"
#include "campaigns/jobs/slurm.h"
#include "cosim/interrupt.h"
#include "run/report/results_folder.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <thread>

namespace puckloop::faults {

namespace fs = std::filesystem;

namespace {

/// All that a campaign writes.
const std::vector<std::string> kResults{"campaign.db", "campaign.db-journal", "nominal",
                                        "boots",       "snapshots",           "slurm",
                                        "work",        "results.csv",         "report.html"};

/// A case whose process died three times is a failure of puckloop's.
nlohmann::json deadly_verdict(const jobs::Job& job, const std::string& why) {
    return to_json(failed_verdict(case_from_json(job.what).faults.size(), why));
}

class Conduct {
  public:
    explicit Conduct(const CampaignOptions& options)
        : options_(options),
          campaign_(read_campaign(options.file)),
          scenario_(scenario_of(campaign_)),
          out_(fs::absolute(options.out.empty() ? fs::path("out") / options.file.stem() : options.out)),
          lock_(out_, kResults) {
        options_.file = fs::absolute(options.file);
        campaign_.file = options_.file;
        if (options.slurm) jobs::check_slurm();
        check_independence();
        for (const Sweep& sweep : campaign_.sweeps)
            check_sweep(campaign_, scenario_, sweep, work_folder(out_) / "check");
        if (options.fresh) {
            jobs::end_tasks(slurm());
            drop();
        }
        store_.emplace(out_ / "campaign.db", Store::Access::Write);
        claim();
    }

    void run() {
        // First: tasks of a campaign that was killed write there until they are ended.
        if (store_->planned("single")) jobs::resume_slurm(slurm(), take());
        jobs::remove_folder(work_folder(out_));
        if (!options_.snapshots) jobs::remove_folder(out_ / "snapshots");
        for (const std::uint64_t seed : campaign_.seeds)
            run_nominal(seed);
        phase("single", [&](int) { return plan_singles(campaign_, scenario_, nominals_); });
        for (int round = 1; round == 1 || !store_->cases(fewer_name(round - 1)).empty(); ++round)
            phase(fewer_name(round), [&](int first) {
                return plan_fewer(campaign_, scenario_, store_->results(), first, fewer_name(round));
            });
        phase("pair", [&](int first) { return plan_pairs(campaign_, store_->results(), first); });
        jobs::remove_folder(work_folder(out_));
        const Results results{campaign_, out_, store_->results(), store_->pruned()};
        write_table(results);
        write_html(results);
        fmt::print("{}", summary(results));
        const auto failures =
            std::count_if(results.results.begin(), results.results.end(), [](const CaseResult& result) {
                return result.verdict.outcome == Outcome::PuckloopFailed;
            });
        if (failures > 0)
            fmt::print(stderr, "puckloop: in {} case{} puckloop itself failed: {} nothing of the robot\n",
                       failures, failures == 1 ? "" : "s", failures == 1 ? "it shows" : "they show");
    }

  private:
    static std::string fewer_name(int round) { return round == 1 ? "fewer" : fmt::format("fewer {}", round); }

    /// Cases run side by side and in any order: none may leave anything to the next.
    void check_independence() const {
        for (const scenarios::RobotBoards& robot : scenario_.robots)
            if (!robot.pic.nvm.empty() || (robot.rab && !robot.rab->nvm.empty()))
                throw InputError(campaign_.scenario.string(), robot.name,
                                 "'nvm' keeps a board's flash from one run to the next: cases of a campaign "
                                 "have to be independent",
                                 "a scenario without it");
    }

    /// Only what a campaign writes.
    void drop() {
        for (const std::string& name : kResults)
            jobs::remove_folder(out_ / name);
    }

    void claim() {
        const auto before = store_->note("identity");
        const std::string now = identity_of(campaign_, scenario_);
        if (before && *before != now)
            throw InputError(
                out_.string(), "",
                "has results of another campaign: the campaign file, its scenario, an image or program of "
                "it, or this build of puckloop has changed",
                "--fresh to drop them, or --out with another folder");
        if (before) return;
        store_->set_note("campaign", options_.file.string());
        store_->set_note("environment", nlohmann::json(campaign_.environment).dump());
        store_->set_note("identity", now);
    }

    void run_nominal(std::uint64_t seed) {
        const fs::path folder = nominal_folder(out_, seed);
        const std::string key = fmt::format("nominal {}", seed);
        if (!store_->note(key)) {
            Case nominal;
            nominal.seed = seed;
            execute_nominal(nominal, folder);
        }
        Profile profile = read_profile(folder);
        if (!profile.report.value("success", false))
            throw RunError(fmt::format("the nominal run with seed {} failed: {}", seed,
                                       profile.report.value("ended_why", "")));
        for (const Metric& metric : campaign_.metrics)
            if (!measure(metric, profile))
                throw InputError(campaign_.file.string(), fmt::format("metric '{}'", metric.name),
                                 "the nominal run has no such number",
                                 !metric.log.empty()    ? "the node of a program, such as robot0.linux"
                                 : metric.robot.empty() ? "a number in report.json"
                                                        : "the name of a robot");
        store_->set_note(key, profile.report.value("trace_sha256", ""));
        fmt::print(stderr, "nominal run: {:.3f} s simulated, seed {}\n",
                   profile.report.value("simulated_s", 0.0), seed);
        nominals_.emplace(seed, std::move(profile));
    }

    /// Again if something outside ended it, as a case is.
    void execute_nominal(const Case& nominal, const fs::path& folder) const {
        for (int tries = 1;; ++tries) {
            std::string why;
            try {
                return execute(campaign_, nominal, folder, {boots_folder(out_)});
            } catch (const jobs::Killed& killed) {
                why = killed.what();
            } catch (const PuckloopFailed& failure) {
                throw RunError(
                    fmt::format("the nominal run with seed {} failed: {}", nominal.seed, failure.what()));
            }
            if (*interrupt_.flag() != 0 || tries == jobs::kTries)
                throw RunError(
                    fmt::format("the nominal run with seed {}, {} {}: {}; the same command goes on",
                                nominal.seed, tries, tries == 1 ? "try" : "tries", why));
            fmt::print(stderr, "puckloop: nominal run, seed {}: {}: it is run again\n", nominal.seed, why);
        }
    }

    /// Of the nominal runs, before the faults of these cases begin.
    void save_prefixes(const std::vector<Case>& cases) {
        // A snapshot costs as much as a case or two.
        constexpr std::size_t kFewest = 4;
        for (const std::uint64_t seed : campaign_.seeds) {
            std::vector<cosim::Time> begins;
            for (const Case& one : cases)
                if (one.seed == seed) begins.push_back(first_begin(campaign_, scenario_, one));
            if (begins.size() < kFewest) continue;
            CaseStart start{boots_folder(out_)};
            start.snapshots = snapshots_folder(out_, seed);
            start.save_at = instants(start.snapshots, begins);
            if (start.save_at.empty()) continue;
            std::error_code error;
            fs::create_directories(start.snapshots, error);
            if (error)
                throw RunError(
                    fmt::format("{}: cannot be made: {}", start.snapshots.string(), error.message()));
            Case nominal;
            nominal.seed = seed;
            try {
                execute(campaign_, nominal, work_folder(out_) / "prefix", start);
                fmt::print(stderr, "saved at {} instants from {:.3f} s on, seed {}\n", start.save_at.size(),
                           cosim::to_seconds(start.save_at.front()), seed);
            } catch (const std::runtime_error& problem) {
                // Cases are executed whole; if the disk is full they will say so.
                fmt::print(stderr, "no snapshots: {}\n", problem.what());
                jobs::remove_folder(start.snapshots);
            }
        }
    }

    template <typename Plan>
    void phase(const std::string& name, Plan plan) {
        if (!store_->planned(name)) store_->plan(name, plan(store_->last_id() + 1));
        const std::vector<Case> cases = store_->cases(name), pending = store_->pending(name);
        const auto pruned =
            std::count_if(cases.begin(), cases.end(), [](const Case& one) { return !one.pruned.empty(); });
        if (cases.empty()) return;
        if (options_.snapshots) save_prefixes(pending);
        const auto begun = std::chrono::steady_clock::now();
        if (options_.slurm && !pending.empty())
            jobs::run_slurm(slurm(), jobs_of(pending), take());
        else
            jobs::run_local({.crew = crew(),
                             .jobs = workers(),
                             .deadly = deadly_verdict,
                             .interrupted = interrupt_.flag()},
                            jobs_of(pending), take());
        const double minutes =
            std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count() / 60;
        fmt::print(stderr, "{}: {} case{}, {} pruned, {} run now", name, cases.size(),
                   cases.size() == 1 ? "" : "s", pruned, pending.size());
        if (!pending.empty()) fmt::print(stderr, " ({:.0f} a minute)", double(pending.size()) / minutes);
        fmt::print(stderr, "\n");
    }

    static std::vector<jobs::Job> jobs_of(const std::vector<Case>& cases) {
        std::vector<jobs::Job> list;
        for (const Case& one : cases)
            list.push_back({one.id, to_json(one)});
        return list;
    }
    jobs::TakeResult take() {
        return [this](int id, const nlohmann::json& verdict) { store_->add_result(id, verdict); };
    }
    jobs::Crew crew() const { return {{"faults", "worker", options_.file.string(), out_.string()}}; }
    jobs::SlurmOptions slurm() const {
        return {crew(), out_, options_.tasks, interrupt_.flag(), deadly_verdict};
    }
    int workers() const {
        return options_.jobs > 0 ? options_.jobs
                                 : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    }

    CampaignOptions options_;
    Campaign campaign_;
    scenarios::Scenario scenario_;
    fs::path out_;
    jobs::FolderLock lock_;
    std::optional<Store> store_;
    Nominals nominals_;
    cosim::InterruptGuard interrupt_;
};

}  // namespace

void run_campaign(const CampaignOptions& options) {
    Conduct(options).run();
}

Results read_results(const fs::path& out) {
    const Store store(out / "campaign.db", Store::Access::Read);
    const auto file = store.note("campaign");
    if (!file) throw InputError(out.string(), "", "the campaign was ended before it began", "start it again");
    // What its file names from the environment is as it was: a replay is typed in some other shell.
    const nlohmann::json environment = nlohmann::json::parse(store.note("environment").value_or("{}"));
    for (const auto& [name, value] : environment.items())
        ::setenv(name.c_str(), value.get<std::string>().c_str(), 1);
    Results results{read_campaign(*file), fs::absolute(out), store.results(), store.pruned()};
    const auto now = [&]() -> std::optional<std::string> {
        try {
            return identity_of(results.campaign, scenario_of(results.campaign));
        } catch (const InputError&) {
            return std::nullopt;  // what is there can be shown all the same
        }
    };
    if (store.note("identity") != now())
        fmt::print(stderr,
                   "puckloop: {}: the campaign file, its scenario, an image or program of it, or this build "
                   "of puckloop has changed since\n",
                   out.string());
    return results;
}

Verdict replay(const Results& results, int id, const fs::path& folder) {
    const auto found = std::find_if(results.results.begin(), results.results.end(),
                                    [&](const CaseResult& result) { return result.one.id == id; });
    if (found == results.results.end())
        throw InputError(results.out.string(), fmt::format("case {}", id), "there is no result of it",
                         "a case of results.csv that was run");
    refuse_to_empty(folder, tools::kRunMark, "--out with a folder of its own");
    // Whole, not from a snapshot: a second opinion.
    return run_case(results.campaign, found->one, folder, {boots_folder(results.out)},
                    read_profile(nominal_folder(results.out, found->one.seed)));
}

}  // namespace puckloop::faults
