#include "campaigns/engine/worker.h"

#include "campaigns/engine/case_run.h"
#include "campaigns/engine/plan.h"

namespace puckloop::faults {

namespace fs = std::filesystem;
using nlohmann::json;

fs::path nominal_folder(const fs::path& out, std::uint64_t seed) {
    return out / "nominal" / std::to_string(seed);
}

fs::path boots_folder(const fs::path& out) {
    return out / "boots";
}

fs::path work_folder(const fs::path& out) {
    return out / "work";
}

namespace {

class Runner {
  public:
    explicit Runner(const WorkerTask& task)
        : task_(task),
          campaign_(read_campaign(task.campaign)),
          scenario_(scenario_of(campaign_)),
          prefixes_(task.out) {
        folder_ = jobs::own_folder(work_folder(task.out));
    }
    ~Runner() {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }
    Runner(const Runner&) = delete;
    Runner& operator=(const Runner&) = delete;

    json result(const Case& one) {
        CaseStart start{boots_folder(task_.out)};
        start.snapshot = prefixes_.before(one.seed, first_begin(campaign_, scenario_, one));
        return to_json(run_case(campaign_, one, folder_, start, nominal(one.seed)));
    }

  private:
    const Profile& nominal(std::uint64_t seed) {
        const auto found = nominals_.find(seed);
        if (found != nominals_.end()) return found->second;
        return nominals_.emplace(seed, read_profile(nominal_folder(task_.out, seed))).first->second;
    }

    WorkerTask task_;
    Campaign campaign_;
    scenarios::Scenario scenario_;
    Prefixes prefixes_;
    fs::path folder_;
    Nominals nominals_;
};

}  // namespace

void work(const WorkerTask& task) {
    Runner runner(task);
    jobs::work(task.share, [&](const json& job) { return runner.result(case_from_json(job)); });
}

}  // namespace puckloop::faults
