#pragma once
// A process that serves one node of a run: this very program, started by the conductor under the node's name.

#include <optional>

namespace puckloop::tools {

/// The exit status, if the conductor started this process for a node ("puckloop: robot0.pic" is all there is
/// of its command line, and the memory to share is on its descriptors); nothing in a process that a user
/// started.
std::optional<int> serve_as_node(int count, char** words);

/// No dsPIC program is translated in this process from here on, and, if asked, in its nodes' processes (by a
/// variable in their environment, which they remove at once).
void interpret_from_here(bool in_nodes_too);

}  // namespace puckloop::tools
