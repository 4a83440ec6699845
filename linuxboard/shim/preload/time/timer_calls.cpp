// alarm, setitimer, timerfd, pause and waiting for signals.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/scheduler/signal_origins.h"
#include "linuxboard/shim/preload/scheduler/timers.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <poll.h>
#include <signal.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/timerfd.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>

using namespace puckloop::shim;

namespace {
timeval to_timeval(Time time) {
    return {time / kSecond, time % kSecond / kMicrosecond};
}
Time left_of(const Timer& timer) {
    return timer.deadline == kNever
               ? 0
               : std::max<Time>(board_time(std::max<Time>(timer.deadline - now(), 1)), 1);
}

itimerspec read_timer(const Timer& timer) {
    return {to_timespec(timer.interval), to_timespec(left_of(timer))};
}
/// timer_settime() and timerfd_settime(): 0, or -1 and errno.
int set_timer(Timer* timer, bool absolute, const itimerspec* theirs, itimerspec* old) {
    itimerspec value{};
    if (!get_from_program(value, theirs)) return -1;
    const bool valid = is_valid(value.it_value) && is_valid(value.it_interval) &&
                       value.it_value.tv_sec >= 0 && value.it_interval.tv_sec >= 0;
    if (!valid || !is_timer(timer)) return fail(EINVAL);
    if (old != nullptr && !put_to_program(old, read_timer(*timer))) return -1;
    const Time first = from_timespec(value.it_value);
    timer->interval = from_timespec(value.it_interval);
    timer->deadline = first == 0 ? kNever
                      : absolute ? absolute_deadline(timer->clock, value.it_value)
                                 : time_after(first);
    return 0;
}

/// Waits for one of `set`; the signal's number, 0 at the deadline, -1 if the handler of another one ran.
int await_signal(const sigset_t* set, Time deadline) {
    mark_call("sigwait");
    pthread_testcancel();
    charge(page().charges.sync);
    // One that came while it was blocked is kept by the host.
    const timespec at_once{};
    if (const int kept = REAL(sigtimedwait)(set, nullptr, &at_once); kept > 0) {
        if (!take_origin(kept)) own().origins[kept] = {own().number, 0, 0};
        return kept;
    }
    Thread* me = self();
    me->awaited_signals = set;
    me->taken_signal = 0;
    static const char key = 0;
    WaitOptions options;
    options.deadline = deadline;
    options.interruptible = true;
    options.cancellable = true;
    const Wake reason = park(&key, options);
    me->awaited_signals = nullptr;
    return me->taken_signal == 0 && reason == Wake::Signal ? -1 : me->taken_signal;
}
}  // namespace

SHIM_EXPORT unsigned alarm(unsigned seconds) noexcept {
    if (!active()) return REAL(alarm)(seconds);
    charge(page().charges.clock);
    Timer& timer = real_timer();
    const Time left = left_of(timer);
    timer.signal = SIGALRM;
    timer.interval = 0;
    timer.deadline = seconds == 0 ? kNever : time_after(seconds * kSecond);
    return static_cast<unsigned>((left + kSecond - 1) / kSecond);
}

SHIM_EXPORT useconds_t ualarm(useconds_t microseconds, useconds_t interval) noexcept {
    if (!active()) return REAL(ualarm)(microseconds, interval);
    charge(page().charges.clock);
    Timer& timer = real_timer();
    const Time left = left_of(timer);
    timer.signal = SIGALRM;
    timer.interval = interval * kMicrosecond;
    timer.deadline = microseconds == 0 ? kNever : time_after(microseconds * kMicrosecond);
    return static_cast<useconds_t>(left / kMicrosecond);
}

SHIM_EXPORT int getitimer(__itimer_which_t which, itimerval* value) noexcept {
    if (!active() || which != ITIMER_REAL) return REAL(getitimer)(which, value);
    const itimerval current{to_timeval(real_timer().interval), to_timeval(left_of(real_timer()))};
    return put_to_program(value, current) ? 0 : -1;
}

SHIM_EXPORT int setitimer(__itimer_which_t which, const itimerval* value, itimerval* old) noexcept {
    if (!active()) return REAL(setitimer)(which, value, old);
    if (which != ITIMER_REAL) {
        if (which == ITIMER_VIRTUAL || which == ITIMER_PROF)
            note("setitimer: timers of processor time are not supported");
        return fail(EINVAL);
    }
    charge(page().charges.clock);
    itimerval given{};  // Linux takes no value for one of zeros
    if (value != nullptr && !get_from_program(given, value)) return -1;
    const auto is_time = [](const timeval& time) {
        return time.tv_sec >= 0 && time.tv_usec >= 0 && time.tv_usec < 1'000'000;
    };
    if (!is_time(given.it_value) || !is_time(given.it_interval)) return fail(EINVAL);
    if (old != nullptr && getitimer(which, old) != 0) return -1;
    Timer& timer = real_timer();
    timer.signal = SIGALRM;
    const auto time_of = [](const timeval& time) {
        return from_timespec({time.tv_sec, time.tv_usec * 1000});
    };
    timer.interval = time_of(given.it_interval);
    const Time first = time_of(given.it_value);
    timer.deadline = first == 0 ? kNever : time_after(first);
    return 0;
}

SHIM_EXPORT int timer_create(clockid_t clock, sigevent* event, timer_t* id) noexcept {
    if (!active()) return REAL(timer_create)(clock, event, id);
    charge(page().charges.clock);
    sigevent given{};
    if (event != nullptr && !get_from_program(given, event)) return -1;
    if (event != nullptr) event = &given;
    if (is_processor_clock(clock)) {
        note("timer_create: timers of processor time are not supported");
        return fail(ENOTSUP);
    }
    if (event != nullptr && event->sigev_notify != SIGEV_SIGNAL && event->sigev_notify != SIGEV_NONE) {
        note(
            "timer_create: timers that start threads are not supported (signals, setitimer and timerfd are)");
        return fail(ENOTSUP);
    }
    Timer* timer = new_timer(-1);
    if (timer == nullptr) return fail(EAGAIN);
    timer->clock = clock;
    timer->signal = event == nullptr ? SIGALRM : event->sigev_notify == SIGEV_SIGNAL ? event->sigev_signo : 0;
    if (put_to_program(id, static_cast<timer_t>(timer))) return 0;
    *timer = {};
    return -1;
}

SHIM_EXPORT int timer_settime(timer_t id, int flags, const itimerspec* value, itimerspec* old) noexcept {
    if (!active()) return REAL(timer_settime)(id, flags, value, old);
    charge(page().charges.clock);
    return set_timer(static_cast<Timer*>(id), (flags & TIMER_ABSTIME) != 0, value, old);
}

SHIM_EXPORT int timer_gettime(timer_t id, itimerspec* value) noexcept {
    if (!active()) return REAL(timer_gettime)(id, value);
    if (!is_timer(id)) return -1;
    return put_to_program(value, read_timer(*static_cast<const Timer*>(id))) ? 0 : -1;
}

SHIM_EXPORT int timer_getoverrun(timer_t id) noexcept {
    if (!active()) return REAL(timer_getoverrun)(id);
    return is_timer(id) ? 0 : -1;
}

SHIM_EXPORT int timer_delete(timer_t id) noexcept {
    if (!active()) return REAL(timer_delete)(id);
    if (!is_timer(id)) return -1;
    *static_cast<Timer*>(id) = {};
    return 0;
}

SHIM_EXPORT int timerfd_create(clockid_t clock, int flags) noexcept {
    if (!active()) return REAL(timerfd_create)(clock, flags);
    charge(page().charges.device);
    const int fd = REAL(eventfd)(0, ((flags & TFD_NONBLOCK) != 0 ? EFD_NONBLOCK : 0) |
                                        ((flags & TFD_CLOEXEC) != 0 ? EFD_CLOEXEC : 0));
    if (fd < 0) return fd;
    mark_internal(fd);
    Timer* timer = new_timer(fd);
    if (timer == nullptr) {
        REAL(close)(fd);
        return fail(EMFILE);
    }
    timer->clock = clock;
    return fd;
}

SHIM_EXPORT int timerfd_gettime(int fd, itimerspec* value) noexcept {
    const Timer* timer = active() ? timer_of(fd) : nullptr;
    if (timer == nullptr) return REAL(timerfd_gettime)(fd, value);
    return put_to_program(value, read_timer(*timer)) ? 0 : -1;
}

SHIM_EXPORT int timerfd_settime(int fd, int flags, const itimerspec* value, itimerspec* old) noexcept {
    Timer* timer = active() ? timer_of(fd) : nullptr;
    if (timer == nullptr) return REAL(timerfd_settime)(fd, flags, value, old);
    charge(page().charges.device);
    if (set_timer(timer, (flags & TFD_TIMER_ABSTIME) != 0, value, old) != 0) return -1;
    // What had run out before and was not read is forgotten.
    pollfd entry{fd, POLLIN, 0};
    std::uint64_t expired = 0;
    if (REAL(poll)(&entry, 1, 0) == 1)
        host_call(SYS_read, fd, reinterpret_cast<long>(&expired), sizeof expired);
    return 0;
}

SHIM_EXPORT int pause() {
    if (!active()) return REAL(pause)();
    mark_call("pause");
    static const char key = 0;
    WaitOptions options;
    options.interruptible = true;
    options.cancellable = true;
    while (park(&key, options) != Wake::Signal) {
    }
    return fail(EINTR);
}

SHIM_EXPORT int sigsuspend(const sigset_t* mask) {
    if (!active()) return REAL(sigsuspend)(mask);
    // One that came while it was blocked ends the wait at once.
    sigset_t waiting;
    sigpending(&waiting);
    bool due = false;
    for (int number = 1; number < NSIG; ++number)
        due = due || (sigismember(&waiting, number) == 1 && sigismember(mask, number) == 0);
    sigset_t before;
    pthread_sigmask(SIG_SETMASK, mask, &before);
    if (!due) pause();
    pthread_sigmask(SIG_SETMASK, &before, nullptr);
    return fail(EINTR);
}

extern "C" {
int __xpg_sigpause(int);
int __sigpause(int, int);
}

namespace {
/// Until a signal, with `set` blocked.
int pause_with(const sigset_t& set) {
    return sigsuspend(&set);
}
}  // namespace

/// That of BSD: the mask's bits are the signals from 1 on.
#undef sigpause
extern "C" __attribute__((visibility("default"))) int puckloop_bsd_sigpause(int mask) asm("sigpause");
int puckloop_bsd_sigpause(int mask) {
    sigset_t set;
    sigemptyset(&set);
    for (int number = 1; number <= 32; ++number)
        if ((static_cast<unsigned>(mask) >> (number - 1) & 1) != 0) sigaddset(&set, number);
    return pause_with(set);
}
/// That of System V: this signal is let through.
SHIM_EXPORT int __xpg_sigpause(int number) {
    sigset_t set;
    pthread_sigmask(SIG_BLOCK, nullptr, &set);
    if (sigdelset(&set, number) != 0) return -1;
    return pause_with(set);
}
SHIM_EXPORT int __sigpause(int mask_or_number, int is_number) {
    return is_number != 0 ? __xpg_sigpause(mask_or_number) : puckloop_bsd_sigpause(mask_or_number);
}

SHIM_EXPORT int sigwait(const sigset_t* set, int* number) {
    if (!active()) return REAL(sigwait)(set, number);
    while ((*number = await_signal(set, kNever)) <= 0) {
    }
    return 0;
}

SHIM_EXPORT int sigtimedwait(const sigset_t* set, siginfo_t* info, const timespec* timeout) {
    if (!active()) return REAL(sigtimedwait)(set, info, timeout);
    const int number = await_signal(set, timeout == nullptr ? kNever : time_after(from_timespec(*timeout)));
    if (number <= 0) {
        errno = number == 0 ? EAGAIN : EINTR;
        return -1;
    }
    if (info != nullptr) {
        *info = {};
        info->si_signo = number;
        show_origin(number, *info);
    }
    return number;
}

SHIM_EXPORT int sigwaitinfo(const sigset_t* set, siginfo_t* info) {
    if (!active()) return REAL(sigwaitinfo)(set, info);
    return sigtimedwait(set, info, nullptr);
}
