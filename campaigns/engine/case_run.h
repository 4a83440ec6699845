#pragma once
// Running one case: a `puckloop run` in a process of its own, and its verdict.

#include "base/error.h"
#include "campaigns/engine/case.h"
#include "campaigns/engine/outcome.h"
#include "campaigns/engine/prefixes.h"
#include "scenarios/description/scenario.h"

#include <filesystem>
#include <memory>
#include <utility>
#include <vector>

namespace puckloop::faults {

/// The scenario with the campaign's changes. Throws InputError.
scenarios::Scenario scenario_of(const Campaign& campaign);

/// Throws InputError, with the campaign's file and `line`, if the scenario cannot have this fault.
void check_fault(const Campaign& campaign, const scenarios::Scenario& scenario, const nlohmann::json& fault,
                 int line);

/// The same for what only a node itself can refuse (a register that its chip has not, a symbol that its
/// firmware has not): makes boards with such faults, with logs in `folder`, and runs nothing. Each fault with
/// its line.
void check_faults_of_nodes(const Campaign& campaign,
                           const std::vector<std::pair<nlohmann::json, int>>& faults,
                           const std::filesystem::path& folder);

/// Where a case begins, and what is kept of it for others.
struct CaseStart {
    std::filesystem::path boots;  ///< where boots of boards are kept from one run to the next
    /// The nominal run before the case's first fault; null: the case is run whole.
    std::shared_ptr<const cosim::RunSnapshot> snapshot{};
    std::vector<cosim::Time> save_at{};  ///< the run is saved there, into
    std::filesystem::path snapshots{};   ///< this folder (prefixes.h)
};

/// The run did not come to its end because the emulator itself crashed or threw.
class PuckloopFailed : public RunError {
  public:
    using RunError::RunError;
};

/// Runs it with all results in `folder`, which it replaces. Throws PuckloopFailed, or RunError if the run
/// could not be made (disk full, its process killed from outside).
void execute(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
             const CaseStart& start);

/// Runs it likewise, and judges it. A case that makes the emulator fail has a verdict like any other; one
/// that does so only when it goes on from a snapshot is run whole, and its verdict's detail states both.
Verdict run_case(const Campaign& campaign, const Case& one, const std::filesystem::path& folder,
                 const CaseStart& start, const Profile& nominal);

}  // namespace puckloop::faults
