#pragma once
// Boards with a saved state: what their node descriptions say of it, and the node around the board.
//
//   "from_state": {"path", "source": "cache" or "file", "board": whose state in that file}
//   "save_state": {"path", "at_ps"}

#include "cosim/resume/resumed_node.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>

namespace puckloop::tools {

/// The board that `make` makes, as it is if the description has nothing of states. A cached state that
/// cannot be used is as if it were not there. Throws InputError for one from a file.
std::unique_ptr<cosim::Node> with_state(const nlohmann::json& spec, cosim::ResumedNode::Make make);

}  // namespace puckloop::tools
