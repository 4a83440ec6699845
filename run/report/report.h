#pragma once
// report.json: what a run did, for people and for programs.

#include "cosim/conductor.h"
#include "run/description/run_setup.h"
#include "run/report/expectation_result.h"
#include "run/report/failures.h"
#include "run/report/provenance.h"
#include "run/report/reserved_file.h"

#include <string>
#include <vector>

namespace puckloop::tools {

/// What to take on disk for the report before the run; one of eight robots with all boards has about a third.
inline constexpr std::size_t kReportBytes = 262'144;

/// Version of report.json; `puckloop schema report` has what is in it.
inline constexpr int kReportFormat = 1;

/// Writes report.json; throws RunError if the disk does not take it.
void write_report(const RunSetup& setup, const cosim::Outcome& outcome, const std::vector<UsedFile>& files,
                  const std::vector<Failure>& failures, const std::vector<ExpectationResult>& expectations,
                  ReservedFile& file);

/// Warnings of the setup, of the run and of its nodes, these with the node's name before them.
std::vector<std::string> warnings_of(const RunSetup& setup, const cosim::Outcome& outcome);

/// A run that lasted as long as it should has failed nevertheless if a program never touched its robot, and
/// any run whose mission program went wrong at its end.
void judge(cosim::Outcome& outcome);

/// A run with warnings has failed, where the user asked for it.
void judge_strictly(const RunSetup& setup, cosim::Outcome& outcome);

/// A few lines for the terminal: how it ended, how fast, what to look at.
std::string summary(const RunSetup& setup, const cosim::Outcome& outcome);

}  // namespace puckloop::tools
