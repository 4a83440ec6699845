#pragma once
// Boards with a saved state (BoardCare of their descriptions): the node around the board.

#include "cosim/resume/resumed_node.h"
#include "run/description/node_description.h"

#include <memory>

namespace puckloop::tools {

/// The board that `make` makes, as it is if the description has nothing of states. A cached state that
/// cannot be used is as if it were not there. Throws InputError for one from a file.
std::unique_ptr<cosim::Node> with_state(const NodeDescription& board, cosim::ResumedNode::Make make);

}  // namespace puckloop::tools
