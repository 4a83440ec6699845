#pragma once
// The board's clocks, as programs read them and wait by them.

#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <time.h>

namespace puckloop::shim {

// time_calls.cpp
bool is_wall_clock(clockid_t clock);
/// Reading of `clock` now, in nanoseconds (a Time since 1970 would not fit).
std::int64_t clock_nanoseconds(clockid_t clock);
timespec timespec_of_nanoseconds(std::int64_t nanoseconds);
Time from_timespec(const timespec& time);
timespec to_timespec(Time time);
/// Simulated time at which `clock` reads `time`.
Time absolute_deadline(clockid_t clock, const timespec& time);
bool is_valid(const timespec& time);
bool sleep_until(Time deadline);

// processor_time.cpp
/// Reading of a clock of processor time, in picoseconds; false if `clock` is none that there is.
bool processor_time(clockid_t clock, Time& reading);
bool is_processor_clock(clockid_t clock);

}  // namespace puckloop::shim
