#pragma once
// What is done for the accelerometer and the microphones, and what is listed of it.

#include "gap/data/written.h"
#include "selftest/emulate/stage.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap::emulate {

/// The loudspeaker of the microphone's acts stands at the origin: its level, counts, and its TOML table.
inline constexpr double kSpeakerLevel = 600;
std::string speaker_table(double x, double y, double level);

/// Turns on the spot before the loudspeaker, ways away from it, spins with the motors on.
std::vector<Act> microphone_acts(std::uint64_t seed, bool brief);
/// A row a microphone, of exchanges in which the robot stood for a while or drove steadily.
WrittenRun microphone_run(const std::vector<Row>& rows);

/// Turns on level and tilted tables, straight drives with starts and stops, spins.
std::vector<Act> accelerometer_acts(std::uint64_t seed, bool brief);
/// Of the same exchanges; what happens while the speed changes is left out, for nobody measured it.
WrittenRun accelerometer_run(const std::vector<Row>& rows, const Act& act);

/// Has the robot stood for a while by row `k`, or is it well inside a drive at even speed?
bool settled(const std::vector<Row>& rows, std::size_t k);
bool steady(const std::vector<Row>& rows, std::size_t k);

}  // namespace puckloop::gap::emulate
