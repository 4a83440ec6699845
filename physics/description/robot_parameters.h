#pragma once
// A robot's physical parameters: the room's, and over them its own.

#include "physics/description/description.h"
#include "physics/description/parameters.h"

#include <map>
#include <string>

namespace puckloop::physics {

inline Parameters with(Parameters parameters, const std::map<std::string, double>& values) {
    for (const auto& [name, value] : values)
        parameters.set(name, value);
    return parameters;
}

inline Parameters parameters_of(const World& world, const Robot& robot) {
    return with(with({}, world.parameters), robot.parameters);
}

}  // namespace puckloop::physics
