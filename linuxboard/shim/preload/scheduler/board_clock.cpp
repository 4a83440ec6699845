#include "linuxboard/shim/preload/scheduler/board_clock.h"

#include "linuxboard/shim/wire/board_clock.h"

namespace puckloop::shim {

Time board_time(Time simulated) {
    return wire::board_time(simulated, page().clock_error);
}

Time simulated_time(Time of_board) {
    return wire::simulated_time(of_board, page().clock_error);
}

Time time_after(Time duration) {
    const Time start = now();
    if (duration < 0) return start;
    duration = simulated_time(duration);
    return start > kNever - duration ? kNever : start + duration;
}

}  // namespace puckloop::shim
