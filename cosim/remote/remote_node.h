#pragma once
// A node in another process, as the conductor sees it: what is asked of it, and what it may answer.

#include "cosim/remote/node_line.h"
#include "cosim/schedule/node_handle.h"

#include <memory>
#include <string>

namespace puckloop::cosim {

/// Sends the node's description; await_ready() waits for the node. `stall_seconds` > 0.
std::unique_ptr<NodeHandle> make_remote_node(std::unique_ptr<NodeLine> line, const std::string& name,
                                             const std::string& json, double stall_seconds);

}  // namespace puckloop::cosim
