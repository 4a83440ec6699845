#pragma once
// The values a robot's sensors have at one instant, in one flat list: names as in signal lists and
// sensors.csv.

#include "physics/description/parameters.h"

#include <array>
#include <cstddef>
#include <string_view>

namespace puckloop::physics {

inline constexpr std::size_t kProximityChannel = 0;        ///< 8: reflected counts
inline constexpr std::size_t kAmbientChannel = 8;          ///< 8: ambient counts
inline constexpr std::size_t kAccelerationChannel = 16;    ///< 3: counts, x right, y rear, z up
inline constexpr std::size_t kBatteryVoltageChannel = 19;  ///< V
inline constexpr std::size_t kBatteryLowChannel = 20;      ///< 1 = low
inline constexpr std::size_t kGroundChannel = 21;          ///< 3: counts left, centre, right
inline constexpr std::size_t kGroundAmbientChannel = 24;   ///< 3: counts
inline constexpr std::size_t kMicrophoneChannel = 27;      ///< 3: level, counts, right, left, rear
inline constexpr std::size_t kMicrophoneLostChannel = 30;  ///< share of samples lost
/// Those in sensors.csv.
inline constexpr std::size_t kRecordedChannels = 31;
// Of robots whose board has an LSM330.
inline constexpr std::size_t kForceChannel = 31;     ///< 3: g forward, left, up; acceleration less gravity
inline constexpr std::size_t kTurnRateChannel = 34;  ///< 3: deg/s about the same axes
inline constexpr std::size_t kChannelCount = 37;

using Channels = std::array<double, kChannelCount>;

/// "proximity0", "acc_x", "battery_v", "ground0", ...
std::string_view channel_name(std::size_t channel);
/// Nothing is published of these while they are 0: a board begins so.
constexpr bool silent_at_zero(std::size_t channel) {
    return channel >= kMicrophoneChannel && channel <= kMicrophoneLostChannel;
}
/// What a published value is rounded to: counts by `count_quantum`, volts to a millivolt, forces to
/// 50 ug, turn rates to 1 mdeg/s.
double channel_quantum(std::size_t channel, double count_quantum);

}  // namespace puckloop::physics
