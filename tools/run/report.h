#pragma once
// report.json: what a run did, for people and for programs.

#include "cosim/conductor.h"
#include "tools/run/setup.h"

#include <string>

namespace puckloop::tools {

/// Writes report.json into the run's folder; throws RunError if the disk does not take it.
void write_report(const RunSetup& setup, const cosim::Outcome& outcome);

/// A few lines for the terminal: how it ended, how fast, what to look at.
std::string summary(const RunSetup& setup, const cosim::Outcome& outcome);

}  // namespace puckloop::tools
