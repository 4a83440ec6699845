#pragma once
// The line to a node in a process of its own: rings in anonymous memory, nothing of it is on the file
// system.

#include "cosim/remote/node_line.h"
#include "cosim/remote/processes/node_processes.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// Starts the process, which ps shows under the node's name. `processes` outlives the line. Throws RunError.
std::unique_ptr<NodeLine> start_node_process(NodeProcesses& processes, const std::string& name,
                                             const std::vector<std::string>& command);

}  // namespace puckloop::cosim
