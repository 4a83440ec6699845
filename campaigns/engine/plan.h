#pragma once
// Which cases a campaign runs.

#include "campaigns/engine/case.h"
#include "campaigns/engine/outcome.h"
#include "scenarios/description/scenario.h"

#include <map>

namespace puckloop::faults {

/// Nominal runs by seed.
using Nominals = std::map<std::uint64_t, Profile>;

struct CaseResult {
    Case one;
    Verdict verdict;
};

/// Throws InputError for faults of a sweep that the scenario cannot have, before any run. `folder`: for what
/// boards leave that are made for it.
void check_sweep(const Campaign& campaign, const scenarios::Scenario& scenario, const Sweep& sweep,
                 const std::filesystem::path& folder);

/// Every fault of every sweep, with every seed; what the nominal run shows to be without effect and what is
/// over the budget is marked as pruned. Throws InputError for faults that the scenario cannot have.
std::vector<Case> plan_singles(const Campaign& campaign, const scenarios::Scenario& scenario,
                               const Nominals& nominals);

/// For each finding of one fault that fired more than once: the same with a smaller `count`. First 1, 2, 4,
/// ... up to what it was; when some of these are known, what is half-way between the smallest count that
/// shows the finding and the next smaller one that does not. Empty when nothing is left between them.
std::vector<Case> plan_fewer(const Campaign& campaign, const scenarios::Scenario& scenario,
                             const std::vector<CaseResult>& results, int first_id, const std::string& phase);

/// Pairs of single faults that were survived, at most the campaign's budget.
std::vector<Case> plan_pairs(const Campaign& campaign, const std::vector<CaseResult>& singles, int first_id);

/// Why a fault can have no effect on a run that is as the nominal one until then; empty: it may have one.
std::string useless(const nlohmann::json& fault, const Profile& nominal);

}  // namespace puckloop::faults
