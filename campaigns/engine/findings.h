#pragma once
// What a campaign found, each thing once.

#include "campaigns/engine/plan.h"

#include <string>
#include <vector>

namespace puckloop::faults {

/// Cases with the same outcome, kinds, places and symptoms.
struct Finding {
    Outcome outcome = Outcome::Hang;
    std::string faults;    ///< "drop on robot0.uart from robot0.pic"; of a pair both, with " + "
    std::string symptoms;  ///< what the run showed, without times
    std::vector<const CaseResult*> cases;
    const CaseResult* smallest = nullptr;  ///< fewest faults, fewest firings, first
};

/// The worst first; `results` in the order of the campaign, and to outlive the findings.
std::vector<Finding> findings_of(const std::vector<CaseResult>& results);

}  // namespace puckloop::faults
