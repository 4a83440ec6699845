// Clocks and sleeping. Simulated time 0 stands at the node's epoch (wall clock) and uptime (monotonic
// clocks).

#include "base/random.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <sys/time.h>
#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>
#include <climits>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;
}

bool is_wall_clock(clockid_t clock) {
    return clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE || clock == CLOCK_REALTIME_ALARM ||
           clock == CLOCK_TAI;
}

static std::int64_t clock_origin(clockid_t clock) {
    return is_wall_clock(clock) ? page().epoch : page().uptime;
}

std::int64_t clock_nanoseconds(clockid_t clock) {
    return clock_origin(clock) + board_time(now()) / kNanosecond;
}

timespec timespec_of_nanoseconds(std::int64_t nanoseconds) {
    timespec out{};
    out.tv_sec = nanoseconds / kNanosecondsPerSecond;
    out.tv_nsec = nanoseconds % kNanosecondsPerSecond;
    return out;
}

Time from_timespec(const timespec& time) {
    if (time.tv_sec > kNever / kSecond - 1) return kNever;
    return time.tv_sec * kSecond + time.tv_nsec * kNanosecond;
}

timespec to_timespec(Time time) {
    timespec out{};
    out.tv_sec = time / kSecond;
    out.tv_nsec = time % kSecond / kNanosecond;
    return out;
}

Time absolute_deadline(clockid_t clock, const timespec& time) {
    constexpr std::int64_t kLast = kNever / kNanosecond;
    if (time.tv_sec >= INT64_MAX / kNanosecondsPerSecond) return kNever;
    const std::int64_t relative = time.tv_sec * kNanosecondsPerSecond + time.tv_nsec - clock_origin(clock);
    if (relative > kLast) return kNever;
    return relative < 0 ? 0 : simulated_time(relative * kNanosecond);
}

bool is_valid(const timespec& time) {
    return time.tv_nsec >= 0 && time.tv_nsec < kNanosecondsPerSecond;
}

/// One that Linux has, and no processor's.
bool is_clock(clockid_t clock) {
    constexpr clockid_t kRemoved = 10;  // CLOCK_SGI_CYCLE
    return clock >= 0 && clock <= CLOCK_TAI && clock != kRemoved;
}

int refuse_to_set() {
    note("the program sets the clock of its computer, which is not supported");
    return fail(EPERM);
}

/// When a sleep that was to end at `deadline` does. Nothing is drawn without jitter.
Time woken(Time deadline) {
    const wire::Oversleep& late = page().oversleep;
    Time more = late.mean;
    if (late.jitter > 0) {
        static RandomStream stream(page().seed, "oversleep");
        more += static_cast<Time>(static_cast<double>(late.jitter) * stream.normal());
    }
    more = std::max(more, std::min<Time>(late.mean, 0));  // early only as far as asked
    return more > 0 && deadline > kNever - more ? deadline : deadline + more;
}

/// Sleeps; true if a signal cut it short. Even a sleep of nothing gives way once.
bool sleep_until(Time deadline) {
    mark_call("sleep");
    charge(page().charges.yield);
    deadline = woken(deadline);
    if (deadline <= now()) {
        yield_token();
        return false;
    }
    static const char kSleepKey = 0;
    WaitOptions options;
    options.deadline = deadline;
    options.interruptible = true;
    options.cancellable = true;
    return park(&kSleepKey, options) == Wake::Signal;
}

}  // namespace puckloop::shim

SHIM_EXPORT int clock_gettime(clockid_t clock, timespec* time) noexcept {
    if (!active()) return REAL(clock_gettime)(clock, time);
    mark_call("clock_gettime");
    charge(page().charges.clock);
    Time computed = 0;
    if (is_processor_clock(clock)) {
        if (!processor_time(clock, computed)) return fail(EINVAL);
        return put_to_program(time, to_timespec(computed)) ? 0 : -1;
    }
    if (!is_clock(clock)) return fail(EINVAL);
    return put_to_program(time, timespec_of_nanoseconds(clock_nanoseconds(clock))) ? 0 : -1;
}

SHIM_EXPORT int clock_getres(clockid_t clock, timespec* resolution) noexcept {
    if (!active()) return REAL(clock_getres)(clock, resolution);
    Time computed = 0;
    if (is_processor_clock(clock) ? !processor_time(clock, computed) : !is_clock(clock)) return fail(EINVAL);
    return resolution == nullptr || put_to_program(resolution, timespec{0, 1}) ? 0 : -1;
}

// The clock of the board is the scenario's, that of the host is none of the program's business.
SHIM_EXPORT int clock_settime(clockid_t clock, const timespec* time) noexcept {
    return active() ? refuse_to_set() : REAL(clock_settime)(clock, time);
}
SHIM_EXPORT int settimeofday(const timeval* time, const struct timezone* zone) noexcept {
    return active() ? refuse_to_set() : REAL(settimeofday)(time, zone);
}
SHIM_EXPORT int adjtime(const timeval* by, timeval* before) noexcept {
    return active() ? refuse_to_set() : REAL(adjtime)(by, before);
}
/// What only asks is answered as of a clock that nothing disciplines.
SHIM_EXPORT int adjtimex(timex* theirs) noexcept {
    if (!active()) return REAL(adjtimex)(theirs);
    timex settings{};
    if (!get_from_program(settings, theirs)) return -1;
    if (settings.modes != 0) return refuse_to_set();
    const timespec wall = timespec_of_nanoseconds(clock_nanoseconds(CLOCK_REALTIME));
    settings = {};
    settings.status = STA_UNSYNC;
    settings.time = {wall.tv_sec, wall.tv_nsec / 1000};
    return put_to_program(theirs, settings) ? TIME_ERROR : -1;
}
SHIM_EXPORT int clock_adjtime(clockid_t clock, timex* settings) noexcept {
    if (!active()) return REAL(clock_adjtime)(clock, settings);
    return clock == CLOCK_REALTIME ? adjtimex(settings) : fail(is_clock(clock) ? EOPNOTSUPP : EINVAL);
}

SHIM_EXPORT int gettimeofday(timeval* time, void* zone) noexcept {
    if (!active()) return REAL(gettimeofday)(time, zone);
    mark_call("gettimeofday");
    charge(page().charges.clock);
    if (time == nullptr) return 0;
    const timespec wall = timespec_of_nanoseconds(clock_nanoseconds(CLOCK_REALTIME));
    return put_to_program(time, timeval{wall.tv_sec, wall.tv_nsec / 1000}) ? 0 : -1;
}

SHIM_EXPORT time_t time(time_t* out) noexcept {
    if (!active()) return REAL(time)(out);
    mark_call("time");
    charge(page().charges.clock);
    const time_t seconds = clock_nanoseconds(CLOCK_REALTIME) / kNanosecondsPerSecond;
    return out != nullptr && !put_to_program(out, seconds) ? -1 : seconds;
}

SHIM_EXPORT int timespec_get(timespec* time, int base) noexcept {
    if (!active()) return REAL(timespec_get)(time, base);
    clock_gettime(CLOCK_REALTIME, time);
    return base;
}

SHIM_EXPORT int clock_nanosleep(clockid_t clock, int flags, const timespec* request, timespec* remain) {
    if (!active()) return REAL(clock_nanosleep)(clock, flags, request, remain);
    if (clock == CLOCK_THREAD_CPUTIME_ID || (!is_processor_clock(clock) && !is_clock(clock))) return EINVAL;
    if (is_processor_clock(clock)) {
        note("clock_nanosleep: sleeping until so much processor time is used is not supported");
        return ENOTSUP;
    }
    timespec wanted{};
    if (!get_from_program(wanted, request)) return EFAULT;
    if (!is_valid(wanted) || wanted.tv_sec < 0) return EINVAL;
    const bool is_absolute = (flags & TIMER_ABSTIME) != 0;
    const Time deadline = is_absolute ? absolute_deadline(clock, wanted) : time_after(from_timespec(wanted));
    if (!sleep_until(deadline)) return 0;
    const timespec left = to_timespec(deadline > now() ? board_time(deadline - now()) : 0);
    if (!is_absolute && remain != nullptr && !put_to_program(remain, left)) return EFAULT;
    return EINTR;
}

SHIM_EXPORT int nanosleep(const timespec* request, timespec* remain) {
    if (!active()) return REAL(nanosleep)(request, remain);
    const int error = clock_nanosleep(CLOCK_MONOTONIC, 0, request, remain);
    if (error == 0) return 0;
    return fail(error);
}

SHIM_EXPORT int usleep(useconds_t microseconds) {
    if (!active()) return REAL(usleep)(microseconds);
    if (!sleep_until(time_after(microseconds * kMicrosecond))) return 0;
    return fail(EINTR);
}

SHIM_EXPORT unsigned sleep(unsigned seconds) {
    if (!active()) return REAL(sleep)(seconds);
    const Time deadline = time_after(seconds * kSecond);
    if (!sleep_until(deadline)) return 0;
    const Time left = deadline <= now() ? 0 : board_time(deadline - now());
    return left <= 0 ? 0 : static_cast<unsigned>((left + kSecond / 2) / kSecond);
}
