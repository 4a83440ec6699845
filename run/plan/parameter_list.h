#pragma once

namespace puckloop::physics {
struct World;
}

namespace puckloop::tools {

/// Prints the table of physical parameters: name, unit, default, range, source; with a world also the value
/// in force there, and below it the values of robots that have their own.
void print_parameters(const physics::World* world);

}  // namespace puckloop::tools
