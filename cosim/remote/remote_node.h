#pragma once
// A node in a process of its own, over a socket pair: nothing of it stands on the file system.

#include "cosim/schedule/node_handle.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::cosim {

/// Starts the process; await_ready() waits for the node. `stall_seconds` > 0.
std::unique_ptr<NodeHandle> make_remote_node(const std::string& name, const std::string& json,
                                             const std::vector<std::string>& command, double stall_seconds);

/// Waits until one of the nodes `which` has something to say, or some tenths of a second.
void await_any(const std::vector<std::unique_ptr<NodeHandle>>& nodes, const std::vector<std::size_t>& which);

}  // namespace puckloop::cosim
