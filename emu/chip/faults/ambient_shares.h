#pragma once
// How much of the range of each sensor of light a burst of ambient light takes.

#include <array>

namespace puckloop::chip {

/// By proximity sensor of an e-puck, or light barrier of a TAM; 0 to 1.
using AmbientShares = std::array<double, 8>;

}  // namespace puckloop::chip
