// System calls for the time, timers and processor time.

#include "linuxboard/shim/preload/syscalls/syscalls.h"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <sys/times.h>
#include <sys/timex.h>
#include <time.h>
#include <unistd.h>

namespace puckloop::shim {

bool time_syscall(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
        PUCKLOOP_SYSCALL(time, time(a[0]));
        PUCKLOOP_SYSCALL(alarm, alarm(a[0]));
#endif
        PUCKLOOP_SYSCALL(clock_gettime, clock_gettime(a[0], a[1]));
        PUCKLOOP_SYSCALL(clock_getres, clock_getres(a[0], a[1]));
        PUCKLOOP_SYSCALL(gettimeofday, gettimeofday(a[0], nullptr));
        PUCKLOOP_SYSCALL(times, times(a[0]));
        PUCKLOOP_SYSCALL(getrusage, getrusage(static_cast<__rusage_who_t>(a[0].value), a[1]));
        PUCKLOOP_SYSCALL(nanosleep, nanosleep(a[0], a[1]));
        PUCKLOOP_SYSCALL(clock_nanosleep, failed(clock_nanosleep(a[0], a[1], a[2], a[3])));
        PUCKLOOP_SYSCALL(clock_settime, clock_settime(a[0], a[1]));
        PUCKLOOP_SYSCALL(settimeofday, settimeofday(a[0], nullptr));
        PUCKLOOP_SYSCALL(adjtimex, adjtimex(a[0]));
        PUCKLOOP_SYSCALL(clock_adjtime, clock_adjtime(a[0], a[1]));
        PUCKLOOP_SYSCALL(setitimer, setitimer(static_cast<__itimer_which_t>(a[0].value), a[1], a[2]));
        PUCKLOOP_SYSCALL(getitimer, getitimer(static_cast<__itimer_which_t>(a[0].value), a[1]));
        PUCKLOOP_SYSCALL(sched_yield, sched_yield());
    default:
        return false;
    }
}

}  // namespace puckloop::shim
