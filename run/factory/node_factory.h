#pragma once
// Makes nodes from their descriptions: the one place that knows how of every kind.

#include "cosim/core/stateful_node.h"
#include "run/description/node_description.h"

#include <memory>
#include <string>

namespace puckloop::tools {

/// At power-up, whatever the description has of states; of a node with has_board(). Throws InputError.
std::unique_ptr<cosim::StatefulNode> make_board(const NodeDescription& board);

/// Throws InputError.
std::unique_ptr<cosim::Node> make_node(const NodeDescription& node);
/// From what encode() gave.
std::unique_ptr<cosim::Node> make_described(const std::string& text);

}  // namespace puckloop::tools
