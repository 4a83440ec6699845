#pragma once
// Whose state a state is: from a board's description.

#include "cosim/resume/board_state.h"
#include "run/description/node_description.h"

namespace puckloop::tools {

/// Of a node with has_board(). Reads the firmware's file for its hash; throws InputError.
cosim::BoardIdentity identity_of(const NodeDescription& board);

/// Parameters that a board has otherwise than when it was saved: "crystal_ppm, seed"; empty: none.
std::string other_parameters(const cosim::BoardIdentity& saved, const NodeDescription& board);

}  // namespace puckloop::tools
