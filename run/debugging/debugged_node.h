#pragma once
// `run --gdb NODE=PLACE`: a board of a run under a debugger.
//
// The board stops inside its advance(), and with it, since everybody waits for it, the whole run: simulated
// time stands still everywhere. Nothing of what the run does depends on that, so the trace stays.

#include "cosim/core/stateful_node.h"

#include <memory>

namespace puckloop::tools {

class BoardDebugger;

/// `board` with its debugger, who must outlive it.
std::unique_ptr<cosim::Node> make_debugged(std::unique_ptr<cosim::StatefulNode> board,
                                           BoardDebugger& debugger);

}  // namespace puckloop::tools
