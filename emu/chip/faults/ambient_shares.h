#pragma once
// How much of each proximity sensor's signal a burst of ambient light swallows.

#include <array>

namespace puckloop::chip {

/// By proximity sensor, 0 to 1.
using AmbientShares = std::array<double, 8>;

}  // namespace puckloop::chip
