#pragma once
// The clock of a Linux board, which is not exactly as fast as simulated time. Picoseconds.

#include <cstdint>

namespace puckloop::linuxboard::wire {

/// `error` of a clock, here and below, in parts of 10^9; + is fast.
inline constexpr std::int64_t kClockUnit = 1'000'000'000;

__extension__ using WideTime = __int128;

/// What the clock has counted at the simulated time `simulated`, 0 or later, rounded down.
constexpr std::int64_t board_time(std::int64_t simulated, std::int64_t error) {
    return static_cast<std::int64_t>(WideTime{simulated} * (kClockUnit + error) / kClockUnit);
}

/// The first simulated time at which it has counted `counted`, 0 or more; INT64_MAX for INT64_MAX and for
/// what comes after the end of time.
constexpr std::int64_t simulated_time(std::int64_t counted, std::int64_t error) {
    if (counted == INT64_MAX) return counted;
    const WideTime rate = kClockUnit + error;
    const WideTime time = (WideTime{counted} * kClockUnit + rate - 1) / rate;
    return time > INT64_MAX ? INT64_MAX : static_cast<std::int64_t>(time);
}

}  // namespace puckloop::linuxboard::wire
