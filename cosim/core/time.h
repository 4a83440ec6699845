#pragma once
// Simulated time: signed 64-bit picoseconds since the start of the run (106 days of range).

#include <cstdint>
#include <limits>

namespace puckloop::cosim {

using Time = std::int64_t;

inline constexpr Time kNanosecond = 1'000;
inline constexpr Time kMicrosecond = 1'000'000;
inline constexpr Time kMillisecond = 1'000'000'000;
inline constexpr Time kSecond = 1'000'000'000'000;
/// Later than anything that happens.
inline constexpr Time kNever = std::numeric_limits<Time>::max();

/// Seconds to the nearest picosecond; `seconds` within +-9e6.
constexpr Time from_seconds(double seconds) {
    return static_cast<Time>(seconds * 1e12 + (seconds < 0 ? -0.5 : 0.5));
}
constexpr double to_seconds(Time time) {
    return static_cast<double>(time) * 1e-12;
}

/// Sum that stays at kNever; both arguments non-negative.
constexpr Time later(Time time, Time delay) {
    return time > kNever - delay ? kNever : time + delay;
}

}  // namespace puckloop::cosim
