#pragma once
// What performance figures are given against: a fixed kernel run by this machine itself, side by side.

namespace puckloop::tools {

/// Millions of steps a second of a chain of dependent integer operations with one table read each: about what
/// a processor's core and first cache can do for an interpreter. Measured for about `wall_s` seconds.
double reference_speed(double wall_s);

}  // namespace puckloop::tools
