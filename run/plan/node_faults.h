#pragma once
// Which nodes carry out a run's faults.

#include "run/description/run_setup.h"

#include <string>

namespace puckloop::tools {

/// Names the faults and gives those of nodes to their nodes' descriptions; again, if faults were added since.
/// Throws InputError for a node that is not there.
void assign_faults(RunSetup& setup);

/// The range-and-bearing board that a fault of its robot's battery reaches, too; empty: none. The battery is
/// the main board's, and the fault's evidence is from there.
std::string shared_with(const RunSetup& setup, const cosim::FaultSpec& fault);

}  // namespace puckloop::tools
