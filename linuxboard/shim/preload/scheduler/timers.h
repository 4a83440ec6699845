#pragma once
// The program's timers in simulated time: alarm and setitimer send a signal, a timerfd counts.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

namespace puckloop::shim {

struct Timer {
    bool used = false;
    Time deadline = kNever;
    int clock = 0;
    Time interval = 0;  ///< 0: once
    int signal = 0;     ///< sent at the deadline, or
    int fd = -1;        ///< a descriptor that counts (an eventfd behind a timerfd)
};

/// ITIMER_REAL.
Timer& real_timer();
/// A new timer for a descriptor; nullptr if there are too many.
Timer* new_timer(int fd);
Timer* timer_of(int fd);
/// Whether it is one that is used; errno EINVAL if not.
bool is_timer(const void* timer);
void drop_timer(int fd);
/// In a forked child: it has none.
void drop_all_timers();
/// Calls `use` for every timer that outlives an exec: ITIMER_REAL and those with a descriptor.
void each_lasting_timer(void (*use)(const Timer&, void*), void* context);

/// Earliest deadline of all timers.
Time next_timer();
/// Fires every timer due at `now`; the signals to send as bits.
std::uint64_t fire_timers(Time now);

}  // namespace puckloop::shim
