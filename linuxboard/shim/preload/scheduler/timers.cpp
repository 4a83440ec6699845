#include "linuxboard/shim/preload/scheduler/timers.h"

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sys/syscall.h>

#include <algorithm>
#include <cerrno>

namespace puckloop::shim {

namespace {
constexpr int kMostTimers = 64;
Timer timers[kMostTimers];  // the first is ITIMER_REAL
}  // namespace

Timer& real_timer() {
    return timers[0];
}

Timer* new_timer(int fd) {
    for (int i = 1; i < kMostTimers; ++i) {
        if (timers[i].used) continue;
        timers[i] = {};
        timers[i].used = true;
        timers[i].fd = fd;
        return &timers[i];
    }
    return nullptr;
}

Timer* timer_of(int fd) {
    for (int i = 1; i < kMostTimers; ++i) {
        if (timers[i].used && fd >= 0 && timers[i].fd == fd) return &timers[i];
    }
    return nullptr;
}

bool is_timer(const void* timer) {
    for (int i = 1; i < kMostTimers; ++i)
        if (timer == &timers[i] && timers[i].used) return true;
    errno = EINVAL;
    return false;
}

void drop_timer(int fd) {
    if (Timer* timer = timer_of(fd)) *timer = {};
}

void drop_all_timers() {
    for (Timer& timer : timers)
        timer = {};
}

void each_lasting_timer(void (*use)(const Timer&, void*), void* context) {
    for (const Timer& timer : timers)
        if (&timer == timers || timer.fd >= 0) use(timer, context);
}

Time next_timer() {
    Time next = kNever;
    for (const Timer& timer : timers)
        next = std::min(next, timer.deadline);
    return next;
}

std::uint64_t fire_timers(Time now) {
    std::uint64_t signals = 0;
    for (Timer& timer : timers) {
        if (timer.deadline > now) continue;
        std::uint64_t count = 1;
        if (timer.interval > 0) {
            const Time interval = simulated_time(timer.interval);
            count += static_cast<std::uint64_t>((now - timer.deadline) / interval);
            timer.deadline += static_cast<Time>(count) * interval;
        } else {
            timer.deadline = kNever;
        }
        if (timer.signal != 0) signals |= std::uint64_t{1} << timer.signal;
        if (timer.fd >= 0) {
            host_call(SYS_write, timer.fd, reinterpret_cast<long>(&count), sizeof count);
            external_changed();
        }
    }
    return signals;
}

}  // namespace puckloop::shim
