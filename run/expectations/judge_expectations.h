#pragma once
// Whether a run did what its scenario expects.

#include "cosim/conductor.h"
#include "run/description/run_setup.h"
#include "run/expectations/line_watch.h"
#include "run/report/expectation_result.h"
#include "run/report/failures.h"

#include <string>
#include <vector>

namespace puckloop::tools {

/// After the run, in the order of the tables: from what its nodes reported, from its logs, trace and
/// trajectory.csv.
std::vector<ExpectationResult> judge_expectations(const RunSetup& setup, const cosim::Outcome& outcome,
                                                  const LineWatch& lines);

/// What is said of one that is not met.
std::string unmet_text(const ExpectationResult& result);

/// The first that is not met makes a run fail that has not failed already; all of them are failures.
void fail_unmet(const RunSetup& setup, const std::vector<ExpectationResult>& results,
                std::vector<Failure>& failures, cosim::Outcome& outcome);

}  // namespace puckloop::tools
