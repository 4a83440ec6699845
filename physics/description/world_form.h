#pragma once
// A world, and what happens to it, in descriptions of nodes.

#include "base/fields/json_value.h"
#include "physics/description/description.h"

#include <string>

namespace puckloop::physics {

struct WorldForm {
    static JsonValue write(const World& world);
    static void read(World& world, const JsonValue& from, const std::string& place);
};

}  // namespace puckloop::physics
