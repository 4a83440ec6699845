#pragma once
// Makes nodes from their JSON descriptions: the one place that knows every kind.

#include "cosim/core/stateful_node.h"

#include <nlohmann/json_fwd.hpp>

#include <memory>
#include <string>

namespace puckloop::tools {

/// A "pic", "rab" or "tam" at power-up, whatever the description states of states.
std::unique_ptr<cosim::StatefulNode> make_board(const nlohmann::json& spec);

/// `json` has "kind": "pic", "rab", "tam", "linux", "world", "ir", "i2c_bus", "outside", "xbee" or "ether",
/// and what that kind needs. Throws InputError.
std::unique_ptr<cosim::Node> make_node(const std::string& json);

}  // namespace puckloop::tools
