#pragma once
// `run --gdb NODE=PLACE`: a board of a run under a debugger.
//
// The board stops inside its advance(), and with it, since everybody waits for it, the whole run: simulated
// time stands still everywhere. Nothing of what the run does depends on that, so the trace stays. There is no
// way back here, the rest of the run having none.

#include "cosim/core/stateful_node.h"

#include <memory>
#include <string>

namespace puckloop::tools {

/// The board around which the debugger sits; it waits for one at `place` (as tools/debug/gdb_socket.h takes
/// it) before its first advance. Throws InputError: nobody can listen there.
std::unique_ptr<cosim::Node> make_debugged(std::unique_ptr<cosim::StatefulNode> board,
                                           const std::string& place);

}  // namespace puckloop::tools
