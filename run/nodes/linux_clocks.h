#pragma once
// Clocks and sleeps of the robots' Linux boards, which on a table are not alike.

#include "scenarios/description/scenario.h"

#include <cstdint>
#include <string>

namespace puckloop::tools {

/// What distinguishes one board's time from another's.
struct BoardClock {
    double error_ppm = 0.0;  ///< of its clock, + is fast
    double oversleep = 0.0;  ///< s: sleeps end so much later than asked
    double jitter = 0.0;     ///< s, standard deviation of that
};

/// Drawn for the node `name`. Error: even within +-20 ppm, the tolerance of usual 32.768 kHz crystals, from
/// which an OMAP3's Linux counts. Oversleep: even within 60 to 100 us with a jitter of 30 us: up to 50 us of
/// timer slack (PR_SET_TIMERSLACK(2)), up to 30.5 us until the next count of that crystal, and an estimate of
/// 20 to 60 us, each board's own, until the scheduler runs the program.
BoardClock draw_clock(std::uint64_t seed, const std::string& name);

/// Of the board of `name`: what the scenario or its overlay states, else drawn if several robots have Linux
/// boards and `ideal_linux_clocks` is not asked for, else ideal.
BoardClock clock_of(const scenarios::Scenario& scenario, const std::string& name,
                    const scenarios::LinuxBoard& board);

}  // namespace puckloop::tools
