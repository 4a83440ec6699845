#include "campaigns/experiment/conduct.h"

#include "base/error.h"
#include "campaigns/experiment/experiment_store.h"
#include "campaigns/experiment/progress.h"
#include "campaigns/experiment/report.h"
#include "campaigns/experiment/tables.h"
#include "campaigns/jobs/folder_lock.h"
#include "campaigns/jobs/pool.h"
#include "campaigns/jobs/result_files.h"
#include "campaigns/jobs/slurm.h"
#include "cosim/interrupt.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <thread>

namespace puckloop::swarm {

namespace fs = std::filesystem;

namespace {

fs::path work_folder(const fs::path& out) {
    return out / "work";
}

fs::path run_folder(const fs::path& out, int id) {
    return out / "runs" / std::to_string(id);
}

/// All that an experiment writes.
const std::vector<std::string> kResults{
    "experiment.db", "experiment.db-journal", "boots", "slurm", "work", "runs", "results.csv", "report.html"};

/// A run whose process died three times has no score.
nlohmann::json failed_run(const jobs::Job&, const std::string& why) {
    RunResult result;
    result.failed = why;
    return to_json(result);
}

class Conduct {
  public:
    explicit Conduct(const ExperimentOptions& options)
        : options_(options),
          experiment_(read_experiment(options.file, options.changes)),
          out_(fs::absolute(options.out.empty() ? fs::path("out") / options.file.stem() : options.out)) {
        options_.file = experiment_.file = fs::absolute(options.file);
        if (!options_.against.empty()) reference_ = read_reference(options_.against);
        if (options_.slurm) jobs::check_slurm();
        runs_ = runs_of(experiment_);
        check_runs();
        lock_.emplace(out_, kResults);
        if (options_.fresh) drop();
        store_.emplace(out_ / "experiment.db", ExperimentStore::Access::Write);
        claim();
    }

    bool run() {
        // Tasks of an experiment that was killed write there until they are ended.
        jobs::resume_slurm(slurm(), take());
        jobs::remove_folder(work_folder(out_));
        run_what_is_left();
        jobs::remove_folder(work_folder(out_));
        const Findings findings{experiment_, out_, store_->results()};
        const std::vector<Cell> cells = cells_of(findings);
        jobs::write_whole(out_ / "results.csv", table_text(findings));
        std::optional<Agreement> agreement;
        if (reference_) agreement = agreement_of(findings, cells, *reference_);
        const std::vector<Comparison> comparisons = comparisons_of(findings, cells);
        jobs::write_whole(out_ / "report.html",
                          report_html(findings, cells, comparisons, agreement, options_.against));
        fmt::print("{}", summary(findings, cells, comparisons, agreement));
        return std::all_of(findings.results.begin(), findings.results.end(),
                           [](const auto& result) { return result.second.failed.empty(); });
    }

  private:
    /// Of every program under every condition the first, before anything is written.
    void check_runs() const {
        for (const Run& run : runs_)
            if (run.seed == experiment_.seeds.front()) check_run(experiment_, run, work_folder(out_));
    }

    /// Only what an experiment writes.
    void drop() {
        jobs::end_tasks(slurm());
        for (const std::string& name : kResults)
            jobs::remove_folder(out_ / name);
    }

    void claim() {
        const auto before = store_->note("identity");
        const std::string changes = to_json(options_.changes).dump();
        const std::string now = identity_of(experiment_) + changes;
        if (before && *before != now)
            throw InputError(
                out_.string(), "",
                "has results of another experiment: the experiment file, its scenario, an image or program "
                "of it, --seeds, --duration or this build of puckloop has changed",
                "--fresh to drop them, or --out with another folder");
        store_->plan(experiment_, runs_);
        if (!before) store_->set_note("identity", now);
        store_->set_note("file", experiment_.file.string());
        store_->set_note("changes", changes);
    }

    void run_what_is_left() {
        const std::map<int, RunResult> done = store_->results();
        std::vector<jobs::Job> left;
        for (const Run& run : runs_)
            if (!done.contains(run.id)) left.push_back({run.id, to_json(run)});
        progress_.emplace(experiment_, runs_, done, options_.slurm ? options_.tasks : workers());
        fmt::print(stderr, "{}", progress_->beginning());
        if (left.empty()) return;
        if (options_.slurm)
            jobs::run_slurm(slurm(), left, take());
        else
            jobs::run_local(
                {.crew = crew(), .jobs = workers(), .deadly = failed_run, .interrupted = interrupt_.flag()},
                left, take());
    }

    jobs::TakeResult take() {
        return [this](int id, const nlohmann::json& result) {
            store_->add_result(id, result);
            if (progress_) fmt::print(stderr, "{}", progress_->take(id, result_from_json(result)));
        };
    }
    jobs::Crew crew() const {
        std::vector<std::string> words{"experiment", options_.file.string(), "--out", out_.string(),
                                       "--worker"};
        const Changes& changes = options_.changes;
        if (changes.seeds > 0) words.insert(words.end(), {"--seeds", std::to_string(changes.seeds)});
        if (changes.duration > 0.0)
            words.insert(words.end(), {"--duration", fmt::format("{}", changes.duration)});
        return {std::move(words), "run"};
    }
    jobs::SlurmOptions slurm() const { return {crew(), out_, options_.tasks, interrupt_.flag(), failed_run}; }
    int workers() const {
        return options_.jobs > 0 ? options_.jobs
                                 : static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    }

    ExperimentOptions options_;
    Experiment experiment_;
    fs::path out_;
    std::optional<Reference> reference_;
    std::vector<Run> runs_;
    std::optional<jobs::FolderLock> lock_;
    std::optional<ExperimentStore> store_;
    std::optional<Progress> progress_;
    cosim::InterruptGuard interrupt_;
};

}  // namespace

bool run_experiment(const ExperimentOptions& options) {
    return Conduct(options).run();
}

void work(const ExperimentOptions& options, const jobs::WorkerTask& share) {
    const Experiment experiment = read_experiment(options.file, options.changes);
    const fs::path own = jobs::own_folder(work_folder(options.out));
    jobs::work(share, [&](const nlohmann::json& job) {
        const Run run = run_from_json(job);
        const fs::path folder = experiment.keep ? run_folder(options.out, run.id) : own;
        return to_json(execute(experiment, run, folder, options.out / "boots"));
    });
    std::error_code ignored;
    fs::remove_all(own, ignored);
}

}  // namespace puckloop::swarm
