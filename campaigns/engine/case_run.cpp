#include "campaigns/engine/case_run.h"

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"
#include "campaigns/jobs/full_disk.h"
#include "campaigns/jobs/isolated.h"
#include "run/factory/node_factory.h"
#include "run/plan/overrides.h"
#include "run/run_scenario.h"
#include "run/setup.h"
#include "scenarios/reader/faults/fault_tables.h"
#include "scenarios/reader/read_scenario.h"

#include <fmt/format.h>

#include <cstdlib>

namespace puckloop::faults {

namespace {

constexpr double kStall = 60.0;  ///< s of wall time: a busy machine must not make a hang

tools::RunRequest request_of(const Campaign& campaign) {
    tools::RunRequest request;
    request.scenario = campaign.scenario;
    request.firmware = campaign.firmware;
    request.linux_command = campaign.program;
    request.duration = campaign.duration;
    request.in_process = true;
    request.threads = 1;
    request.stall_seconds = kStall;
    return request;
}

/// The emulator broke off in the midst of the run. The run's report states it, and the verdict is taken from
/// there; a file that cannot be written is another matter.
bool broke_off(const cosim::Outcome& outcome) {
    return outcome.reason == cosim::EndReason::Failed && outcome.grants > 0 &&
           !jobs::names_full_disk(outcome.text) &&
           outcome.text.find("cannot be written") == std::string::npos &&
           outcome.text.find("cannot write") == std::string::npos;
}

void run_here(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
              const CaseStart& start) {
    tools::RunRequest request = request_of(campaign);
    request.out = folder;
    request.seed = one.seed;
    request.cache = true;
    for (nlohmann::json fault : one.faults) {
        fault["may_not_fire"] = true;  // that is an outcome
        request.faults.push_back(as_words(fault));
    }
    request.snapshot = start.snapshot;
    request.same_origin = true;
    for (const cosim::Time at : start.save_at)
        request.snapshot_at.push_back(cosim::to_seconds(at));
    if (!start.save_at.empty()) {
        request.save = start.snapshots;
        request.save_name = [&](double at) { return snapshot_at(start.snapshots, cosim::from_seconds(at)); };
    }
    const auto run = [&] { return tools::run_scenario(tools::set_up(request), request, {}, nullptr); };
    cosim::Outcome outcome = run();
    if (start.snapshot && !outcome.went_on) {
        request.snapshot = nullptr;
        outcome = run();
    }
    // No fault of the case's: results that cannot be written, say.
    const bool ours = outcome.node.empty() && outcome.text.find("never fired") == std::string::npos;
    if (!outcome.success && !broke_off(outcome) && (ours || jobs::names_full_disk(outcome.text)))
        throw RunError(outcome.text);
    jobs::check_room(folder);
}

}  // namespace

scenarios::Scenario scenario_of(const Campaign& campaign) {
    scenarios::Scenario scenario = scenarios::read_scenario(campaign.scenario);
    tools::apply(request_of(campaign), scenario);
    scenarios::check_ending(scenario);
    return scenario;
}

void check_fault(const Campaign& campaign, const scenarios::Scenario& scenario, const nlohmann::json& fault,
                 int line) {
    scenarios::read_fault(campaign.file.string(), 0, to_toml(fault, line), scenario);
}

void check_faults_of_nodes(const Campaign& campaign,
                           const std::vector<std::pair<nlohmann::json, int>>& faults,
                           const std::filesystem::path& folder) {
    std::error_code error;
    make_folder(folder);
    constexpr std::size_t kAtOnce = 256;
    for (std::size_t from = 0; from < faults.size(); from += kAtOnce) {
        tools::RunRequest request = request_of(campaign);
        request.cache = false;
        request.out = folder;
        for (std::size_t i = from; i < std::min(faults.size(), from + kAtOnce); ++i) {
            nlohmann::json fault = faults[i].first;
            fault["name"] = fmt::format("{} (line {}; {})", value_text(fault.value("kind", "drop")),
                                        faults[i].second, i + 1);
            request.faults.push_back(as_words(fault));
        }
        try {
            for (const tools::PlannedNode& node : tools::set_up(request).nodes)
                if (!node.what.faults.empty() && tools::has_board(node.what)) tools::make_board(node.what);
        } catch (const InputError& refused) {
            throw InputError(campaign.file.string(), "", refused.what());
        }
    }
    std::filesystem::remove_all(folder, error);
}

void execute(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
             const CaseStart& start) {
    std::error_code error;
    std::filesystem::remove_all(folder, error);
    make_folder(folder);
    ::setenv("PUCKLOOP_CACHE", start.boots.c_str(), 1);
    try {
        jobs::run_isolated([&] { run_here(campaign, one, folder, start); });
    } catch (const jobs::Broke& broke) {
        jobs::check_room(folder);
        throw PuckloopFailed(broke.what());
    }
}

Verdict run_case(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
                 const CaseStart& start, const Profile& nominal) {
    Verdict verdict;
    try {
        execute(campaign, one, folder, start);
        verdict = judge(campaign, nominal, read_profile(folder), one.faults.size());
    } catch (const PuckloopFailed& failure) {
        verdict = failed_verdict(one.faults.size(), failure.what());
    }
    if (verdict.outcome != Outcome::PuckloopFailed || !start.snapshot) return verdict;
    const std::string before = verdict.detail;
    CaseStart whole = start;
    whole.snapshot = nullptr;
    verdict = run_case(campaign, one, folder, whole, nominal);
    if (verdict.outcome == Outcome::PuckloopFailed) return verdict;
    fmt::print(stderr, "puckloop: case {}: from a snapshot puckloop failed ({}): it is run whole\n", one.id,
               before);
    verdict.detail += fmt::format("{}from a snapshot puckloop failed ({}), so it was run whole",
                                  verdict.detail.empty() ? "" : "; ", before);
    return verdict;
}

}  // namespace puckloop::faults
