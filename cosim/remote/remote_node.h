#pragma once
// A node in a process of its own, over rings in anonymous memory: nothing of it stands on the file
// system.

#include "cosim/remote/node_processes.h"
#include "cosim/schedule/node_handle.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// Starts the process; await_ready() waits for the node. `stall_seconds` > 0. `processes` outlives the
/// handle.
std::unique_ptr<NodeHandle> make_remote_node(NodeProcesses& processes, const std::string& name,
                                             const std::string& json, const std::vector<std::string>& command,
                                             double stall_seconds);

}  // namespace puckloop::cosim
