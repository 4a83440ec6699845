#pragma once
// The board's clock, which is fast or slow by Page::clock_error, and simulated time.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

namespace puckloop::shim {

/// What the board's clocks count in `simulated` time, and the simulated time in which they count so much, at
/// least.
Time board_time(Time simulated);
Time simulated_time(Time of_board);
/// Simulated time at which the board has counted `duration` from now on; kNever stays.
Time time_after(Time duration);

}  // namespace puckloop::shim
