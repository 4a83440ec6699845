#pragma once
// What a campaign found, each thing once.

#include "campaigns/engine/plan.h"

#include <string>
#include <vector>

namespace puckloop::faults {

/// Cases with the same outcome, cause, kinds, places and symptoms.
struct Finding {
    Outcome outcome = Outcome::Hang;
    std::string faults;    ///< "drop on robot0.uart from robot0.pic"; of a pair both, with " + "
    std::string cause;     ///< what went wrong first, without times
    std::string symptoms;  ///< what the run showed, without times
    std::vector<const CaseResult*> cases;
    const CaseResult* smallest = nullptr;  ///< fewest faults, fewest firings, first
};

/// The worst first; `results` in the order of the campaign, and to outlive the findings.
std::vector<Finding> findings_of(const std::vector<CaseResult>& results);

/// Findings that the same thing explains: whatever the fault was, this went wrong first.
struct Cause {
    Outcome outcome = Outcome::Hang;
    std::string what;
    std::vector<const Finding*> findings;
    std::size_t cases = 0;
};

/// The worst first; `findings` as findings_of() gives them, and to outlive the causes.
std::vector<Cause> causes_of(const std::vector<Finding>& findings);

}  // namespace puckloop::faults
