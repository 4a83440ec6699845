// The process as a whole: begin, end, random numbers; and futexes, which reach the
// kernel through syscall().

#include "linuxboard/shim/preload/calls.h"
#include "linuxboard/shim/preload/files/open_file.h"
#include "linuxboard/shim/preload/host.h"
#include "linuxboard/shim/preload/processes/inheritance.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/real.h"

#include <linux/futex.h>
#include <sys/random.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

using namespace puckloop::shim;

namespace puckloop::shim {

void prepare_threads(Thread* main_thread);

namespace {
void leave_by_exit(int status, void*) {
    if (active()) std::fflush(nullptr);  // a pipe may be full: that is waited for in simulated time
    announce_exit(status);
}

void left_by_unknown_fork() {
    if (!is_making_process())
        refuse("a child process that was not made by fork(), posix_spawn(), system() or popen(): ended");
    go_passive();
}
}  // namespace

void begin_process(Thread* main_thread) {
    prepare_threads(main_thread);
    // Registered first, so it runs after everything the program registers.
    on_exit(leave_by_exit, nullptr);
    pthread_atfork(nullptr, nullptr, left_by_unknown_fork);
    // What a program has said is in the log even if it is killed.
    if (std::getenv("_STDBUF_O") == nullptr) std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
    take_over(say_hello(false));
    adopt_standard_streams();
}

}  // namespace puckloop::shim

SHIM_EXPORT void _exit(int status) {
    announce_exit(status);
    REAL(_exit)(status);
    __builtin_unreachable();
}

SHIM_EXPORT void _Exit(int status) noexcept {
    _exit(status);
}

SHIM_EXPORT ssize_t getrandom(void* buffer, size_t size, unsigned flags) {
    if (!active()) return REAL(getrandom)(buffer, size, flags);
    random_bytes(buffer, size);
    return static_cast<ssize_t>(size);
}

SHIM_EXPORT int getentropy(void* buffer, size_t size) {
    if (!active()) return REAL(getentropy)(buffer, size);
    random_bytes(buffer, size);
    return 0;
}

// std::random_device asks the processor where it can; this is its way to a number in libstdc++.
SHIM_EXPORT unsigned _ZNSt13random_device9_M_getvalEv(void*) {
    unsigned value = 0;
    if (active()) {
        random_bytes(&value, sizeof value);
    } else {
        REAL(getrandom)(&value, sizeof value, 0);
    }
    return value;
}

namespace {
/// FUTEX_WAIT and FUTEX_WAKE among the program's threads; false if it is another operation.
bool futex(long* result, std::uint32_t* word, int operation, std::uint32_t value, const timespec* timeout,
           std::uint32_t bits) {
    const int command = operation & FUTEX_CMD_MASK;
    const bool waits = command == FUTEX_WAIT || command == FUTEX_WAIT_BITSET;
    if (command == FUTEX_WAKE || command == FUTEX_WAKE_BITSET) {
        const int count = static_cast<int>(std::min<std::uint32_t>(value, INT_MAX));
        *result = wake(word, count, command == FUTEX_WAKE_BITSET ? bits : ~std::uint64_t{0});
        charge(page().charges.sync);
        return true;
    }
    if (!waits) return false;
    mark_call("futex");
    charge(page().charges.sync);
    *result = -1;
    if (__atomic_load_n(word, __ATOMIC_SEQ_CST) != value) {
        errno = EAGAIN;
        return true;
    }
    WaitOptions options;
    options.interruptible = true;
    if (command == FUTEX_WAIT_BITSET) options.bits = bits;
    if (timeout != nullptr) {
        const clockid_t clock = (operation & FUTEX_CLOCK_REALTIME) != 0 ? CLOCK_REALTIME : CLOCK_MONOTONIC;
        options.deadline =
            command == FUTEX_WAIT ? time_after(from_timespec(*timeout)) : absolute_deadline(clock, *timeout);
    }
    switch (park_shared(word, options, (operation & FUTEX_PRIVATE_FLAG) == 0)) {
    case Wake::Timeout:
        errno = ETIMEDOUT;
        break;
    case Wake::Signal:
        errno = EINTR;
        break;
    default:
        *result = 0;
        break;
    }
    return true;
}
}  // namespace

SHIM_EXPORT long syscall(long number, ...) noexcept {
    std::va_list list;
    va_start(list, number);
    long a[6];
    for (long& argument : a)
        argument = va_arg(list, long);
    va_end(list);
    if (active()) {
        long result = 0;
        switch (number) {
        case SYS_futex:
            if (futex(&result, reinterpret_cast<std::uint32_t*>(a[0]), static_cast<int>(a[1]),
                      static_cast<std::uint32_t>(a[2]), reinterpret_cast<const timespec*>(a[3]),
                      static_cast<std::uint32_t>(a[5])))
                return result;
            note("futex operation 0x%lx is left to the host", a[1]);
            break;
        case SYS_clock_gettime:
            return clock_gettime(static_cast<clockid_t>(a[0]), reinterpret_cast<timespec*>(a[1]));
        case SYS_getrandom:
            random_bytes(reinterpret_cast<void*>(a[0]), static_cast<std::size_t>(a[1]));
            return a[1];
        case SYS_read:
            return read(static_cast<int>(a[0]), reinterpret_cast<void*>(a[1]),
                        static_cast<std::size_t>(a[2]));
        case SYS_write:
            return write(static_cast<int>(a[0]), reinterpret_cast<const void*>(a[1]),
                         static_cast<std::size_t>(a[2]));
        default:
            break;
        }
    }
    return REAL(syscall)(number, a[0], a[1], a[2], a[3], a[4], a[5]);
}
