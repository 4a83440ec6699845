// Processor time. It is what the model charges: each call taken over costs its class (wire::Charges), and
// computing costs nothing; waiting does not count. All of it is system time.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/times.h>
#include <time.h>
#include <unistd.h>

#include <cerrno>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
// How the kernel makes a clock's number of a process's or a thread's (posix-timers.h).
constexpr clockid_t kKind = 3, kScheduler = 2, kNoProcess = 3, kOfThread = 4;

clockid_t clock_of(pid_t number, bool thread) {
    return static_cast<clockid_t>(~static_cast<unsigned>(number) << 3) | kScheduler |
           (thread ? kOfThread : 0);
}

bool thread_time(pid_t number, Time& reading) {
    for (std::size_t i = 0; i < thread_count(); ++i) {
        const Thread* thread = thread_at(i);
        if (thread == nullptr || (number != 0 ? thread_number(thread->index) != number : thread != self()))
            continue;
        reading = thread->computed;
        return true;
    }
    return false;
}

bool process_time(pid_t number, Time& reading) {
    for (const wire::ProcessEntry& entry : page().processes) {
        const bool meant = number == 0 ? &entry == &own() : entry.number == number;
        if (entry.state == wire::ProcessEntry::Free || !meant) continue;
        reading = entry.computed;
        return true;
    }
    return false;
}
}  // namespace

bool is_processor_clock(clockid_t clock) {
    return clock < 0 || clock == CLOCK_PROCESS_CPUTIME_ID || clock == CLOCK_THREAD_CPUTIME_ID;
}

bool processor_time(clockid_t clock, Time& reading) {
    if (clock == CLOCK_PROCESS_CPUTIME_ID) return process_time(0, reading);
    if (clock == CLOCK_THREAD_CPUTIME_ID) return thread_time(0, reading);
    if ((clock & kKind) == kNoProcess) return false;
    const pid_t number = ~(clock >> 3);
    return (clock & kOfThread) != 0 ? thread_time(number, reading) : process_time(number, reading);
}

}  // namespace puckloop::shim

SHIM_EXPORT clock_t clock() noexcept {
    if (!active()) return REAL(clock)();
    mark_call("clock");
    charge(page().charges.clock);
    return own().computed / (kSecond / CLOCKS_PER_SEC);
}

SHIM_EXPORT clock_t times(tms* buffer) noexcept {
    if (!active()) return REAL(times)(buffer);
    mark_call("times");
    charge(page().charges.clock);
    const Time tick = kSecond / sysconf(_SC_CLK_TCK);
    const tms used{0, own().computed / tick, 0, own().children_computed / tick};
    if (buffer != nullptr && !put_to_program(buffer, used)) return -1;
    return clock_nanoseconds(CLOCK_MONOTONIC) / (tick / kNanosecond);
}

SHIM_EXPORT int getrusage(__rusage_who_t who, rusage* usage) noexcept {
    if (!active()) return REAL(getrusage)(who, usage);
    mark_call("getrusage");
    charge(page().charges.clock);
    Time used = 0;
    switch (static_cast<int>(who)) {
    case RUSAGE_SELF:
        used = own().computed;
        break;
    case RUSAGE_CHILDREN:
        used = own().children_computed;
        break;
    case RUSAGE_THREAD:
        used = self()->computed;
        break;
    default:
        return fail(EINVAL);
    }
    rusage result{};
    result.ru_stime = {used / kSecond, used % kSecond / kMicrosecond};
    return put_to_program(usage, result) ? 0 : -1;
}

SHIM_EXPORT int clock_getcpuclockid(pid_t process, clockid_t* clock) noexcept {
    if (!active()) return REAL(clock_getcpuclockid)(process, clock);
    Time ignored = 0;
    if (process < 0 || !process_time(process, ignored)) return ESRCH;
    return put_to_program(clock, clock_of(process, false)) ? 0 : EFAULT;
}

SHIM_EXPORT int pthread_getcpuclockid(pthread_t handle, clockid_t* clock) noexcept {
    const Thread* thread = active() ? find_thread(handle) : nullptr;
    if (thread == nullptr) return REAL(pthread_getcpuclockid)(handle, clock);
    *clock = clock_of(thread_number(thread->index), true);
    return 0;
}
