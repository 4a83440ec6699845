#pragma once
// Which of a robot's physical parameters may change while the world is on: sensors age, wheels begin to slip.

#include <string>
#include <string_view>

namespace puckloop::physics {

/// Why `name` cannot become `value` while the world is on; empty: it can. Body and wheels are built once, and
/// what light, cameras and other media go by is theirs.
std::string problem_of_tuning(std::string_view name, double value);

}  // namespace puckloop::physics
