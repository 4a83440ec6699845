#pragma once
// A process that serves one node of a run: this very program, started by the conductor under the node's name.

#include <optional>

namespace puckloop::tools {

/// The exit status, if the conductor started this process for a node ("puckloop: robot0.pic" is all there is
/// of its command line, and the memory to share is on its descriptors); nothing in a process that a user
/// started.
std::optional<int> serve_as_node(int count, char** words);

}  // namespace puckloop::tools
