#pragma once
// The Linux programs of a run, as their nodes are described.

#include "run/description/run_request.h"
#include "run/description/run_setup.h"

#include <cstdint>
#include <string>

namespace puckloop::tools {

/// How many programs there are: the run ends with the last of them.
std::int64_t programs_of(const scenarios::Scenario& scenario);

/// Description of the node `name` (linuxboard/shim/kernel/spec.h).
LinuxProgram linux_program(const RunSetup& setup, const std::string& name, const scenarios::LinuxBoard& board,
                           const RunRequest& request);

}  // namespace puckloop::tools
