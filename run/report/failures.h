#pragma once
// What went wrong in a run that went on to its end: the run has failed, unless the scenario allows it
// (`allow` of [run]).

#include "cosim/conductor.h"
#include "run/description/run_setup.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::tools {

struct Failure {
    std::string node;  ///< node, or link of a silent line
    std::string kind;  ///< as `allow` takes it: "program", "silent_line", "hung"
    std::string text;
    bool allowed = false;
};

/// What is said of a Linux program whose serial port was silent towards it, and why that may be.
std::string silence_text(const std::string& node, std::uint64_t sent, const cosim::Outcome& outcome);

/// `allowed`: kinds. In the order of nodes. A program that ended badly behind its end signal; a program that
/// sent on its serial line and never got a byte back, where no fault is on that line; a board whose program
/// hung in a loop that nothing can end.
std::vector<Failure> failures_of(const RunSetup& setup, const std::vector<std::string>& allowed,
                                 const cosim::Outcome& outcome);

/// The first one that is not allowed makes the run fail.
void judge_failures(const std::vector<Failure>& failures, cosim::Outcome& outcome);

}  // namespace puckloop::tools
