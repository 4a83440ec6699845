#pragma once
// Makes nodes from their JSON descriptions: the one place that knows every kind.

#include "cosim/node.h"

#include <memory>
#include <string>

namespace puckloop::tools {

/// `json` has "kind": "pic", "rab", "linux", "world", "ir", "i2c_bus" or "outside", and what that kind needs.
/// Throws InputError.
std::unique_ptr<cosim::Node> make_node(const std::string& json);

}  // namespace puckloop::tools
