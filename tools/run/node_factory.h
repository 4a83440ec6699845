#pragma once
// Makes nodes from their JSON descriptions: the one place that knows every kind.

#include "cosim/node.h"

#include <memory>
#include <string>

namespace puckloop::tools {

/// `json` has "kind": "pic", "linux", "world", "ir" or "i2c_bus", and what that kind needs. Throws
/// InputError.
std::unique_ptr<cosim::Node> make_node(const std::string& json);

}  // namespace puckloop::tools
