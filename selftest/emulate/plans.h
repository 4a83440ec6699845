#pragma once
// What is done on the emulator for each kind of experiment: the same as a laboratory would do with the robot.

#include "selftest/emulate/stage.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap::emulate {

/// What can be recorded: "motion", "proximity", "ground", "microphone", "accelerometer", "timing", "rab", and
/// "serial": timing of the bytes on the line.
const std::vector<std::string>& recordable_kinds();

/// The acts of one kind; `seed` decides start headings and free drives. `short_plan`: each once and briefly,
/// for tests. Throws InputError for a kind that cannot be recorded.
std::vector<Act> acts_of(std::string_view kind, std::uint64_t seed, bool short_plan);

/// Way of a wheel a motor step.
inline constexpr double kMetresPerStep = 1.288053e-4;
/// The flat face before which the proximity sensors are tried: x of the plane, m.
inline constexpr double kWallFace = 0.30;
/// Printed stripes on the floor of the ground acts: grey at x (m), and whether an edge lies within `reach`.
double stripe_grey(double x);
bool near_edge(double x, double reach);

}  // namespace puckloop::gap::emulate
