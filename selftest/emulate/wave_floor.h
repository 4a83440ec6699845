#pragma once
// A floor printed with a wave of grey along x: a reading that is late shows everywhere.

#include <string>

namespace puckloop::gap::emulate {

/// TOML: an arena with the wave in stripes of a quarter of a millimetre, to 0.2 m on both sides of x = 0.
std::string wave_floor();
/// Mean grey under a ground sensor at x (m), its footprint included.
double wave_grey(double x);
/// Change of grey a metre of x.
double wave_slope(double x);

}  // namespace puckloop::gap::emulate
