#pragma once
// The other end of a remote node: what a node process does all its life.

#include "cosim/schedule/node_handle.h"

namespace puckloop::cosim {

/// Serves one node over the memory at `descriptor` and the next one (protocol::kDescriptor in a process that
/// the conductor started): makes it with `factory`, advances it as granted, finishes it. Errors of the node
/// go to the conductor, which reports them. Returns the process's exit status: 0 after a finish, 1 otherwise.
int serve_node(int descriptor, const NodeFactory& factory);

}  // namespace puckloop::cosim
