#pragma once
// A mission program in any language: JSON lines on its standard input, one answer a line on its standard
// output (docs/missions.md). Simulated time waits for the answer, so that the same program gives the same
// run.

#include "physics/tracker/mission_source.h"
#include "run/mission/mission_program_spec.h"

#include <memory>

namespace puckloop::tools {

/// The program is started by begin(). One that cannot be started, ends, answers nothing within the time-out
/// or nothing that is an answer fails the run with one line that says so. Throws RunError if the log cannot
/// be written.
std::unique_ptr<physics::MissionSource> make_mission_program(MissionProgramSpec spec);

}  // namespace puckloop::tools
