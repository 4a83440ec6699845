#include "linuxboard/control/devices/clock.h"

#include <cmath>
#include <ctime>

namespace puckloop::control {

namespace {

constexpr double kNanoseconds = 1e9;

}  // namespace

double PosixClock::now() {
    timespec time{};
    ::clock_gettime(CLOCK_MONOTONIC, &time);
    return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) / kNanoseconds;
}

void PosixClock::sleep_until(double time) {
    const double left = time - now();
    if (left <= 0) return;
    timespec duration{};
    duration.tv_sec = static_cast<time_t>(left);
    duration.tv_nsec = static_cast<long>((left - std::floor(left)) * kNanoseconds);
    ::nanosleep(&duration, nullptr);
}

}  // namespace puckloop::control
