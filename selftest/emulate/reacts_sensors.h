#pragma once
// Microphones and accelerometer performed again: placements standing, those of rows with still motors.

#include "selftest/emulate/reacts.h"

#include <string_view>

namespace puckloop::gap::emulate {

/// Up to 24 placements of a loudspeaker before a microphone. `longest`: s that the robot stands at most to be
/// looked at when the row was measured; less than it stands anyhow: all of it counts.
std::vector<React> microphone_reacts(const Experiment& experiment, double longest, std::string& why);
/// Up to 24 tilts of the table (0.2 rad and less); rows with accelerations are not made again.
std::vector<React> accelerometer_reacts(const Experiment& experiment, double longest, std::string& why);

/// Rows against the mean of the emulated ones, and their distribution: of levels, or of three axes.
void compare_microphone(const Experiment& experiment, const React& react, const Performed& performed,
                        const Performed& plain, std::vector<Comparison>& comparisons);
void compare_accelerometer(const Experiment& experiment, const React& react, const Performed& performed,
                           const Performed& plain, std::vector<Comparison>& comparisons);

/// The value of a row, or `fallback` without the column; NaN where it is missing.
double value_of(const Run& run, std::string_view name, std::size_t row, double fallback);
/// NaN of none.
double mean_of(const std::vector<double>& values);
/// One reading against the mean of those performed, and both beside what the simulator as it is says.
void compare_reading(double reading, const std::vector<double>& performed, const std::vector<double>& plain,
                     Comparison& mean, Comparison& distribution);

}  // namespace puckloop::gap::emulate
