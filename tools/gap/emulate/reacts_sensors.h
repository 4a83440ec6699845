#pragma once
// Microphones and accelerometer performed again: placements standing, those of rows with still motors.

#include "tools/gap/emulate/reacts.h"

#include <string_view>

namespace puckloop::gap::emulate {

/// Up to 24 placements of a loudspeaker before a microphone.
std::vector<React> microphone_reacts(const Experiment& experiment, std::string& why);
/// Up to 24 tilts of the table (0.2 rad and less); rows with accelerations are not made again.
std::vector<React> accelerometer_reacts(const Experiment& experiment, std::string& why);

/// Rows against the mean of the emulated ones; one ErrorSum of levels, or three, an axis each.
void microphone_errors(const Experiment& experiment, const React& react, const std::vector<Row>& emulated,
                       std::vector<ErrorSum>& errors);
void accelerometer_errors(const Experiment& experiment, const React& react, const std::vector<Row>& emulated,
                          std::vector<ErrorSum>& errors);

/// The value of a row, or `fallback` without the column; NaN where it is missing.
double value_of(const Run& run, std::string_view name, std::size_t row, double fallback);
void add(ErrorSum& sum, double error);

}  // namespace puckloop::gap::emulate
