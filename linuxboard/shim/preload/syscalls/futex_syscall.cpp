// FUTEX_WAIT and FUTEX_WAKE among the program's threads.

#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/syscalls/syscalls.h"
#include "linuxboard/shim/preload/time/clocks.h"

#include <linux/futex.h>
#include <time.h>

#include <algorithm>
#include <cerrno>
#include <climits>

namespace puckloop::shim {

namespace {
bool futex(long* result, std::uint32_t* word, int operation, std::uint32_t value, const timespec* timeout,
           std::uint32_t bits) {
    const int command = operation & FUTEX_CMD_MASK;
    const bool waits = command == FUTEX_WAIT || command == FUTEX_WAIT_BITSET;
    if (command == FUTEX_WAKE || command == FUTEX_WAKE_BITSET) {
        const int count = static_cast<int>(std::min<std::uint32_t>(value, INT_MAX));
        *result = wake(word, count, command == FUTEX_WAKE_BITSET ? bits : ~std::uint64_t{0});
        charge_lock();
        return true;
    }
    if (!waits) return false;
    mark_call("futex");
    charge_lock();
    *result = -1;
    std::uint32_t current = 0;
    timespec time{};
    if (!get_from_program(current, word) || (timeout != nullptr && !get_from_program(time, timeout)))
        return true;
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
            command == FUTEX_WAIT ? time_after(from_timespec(time)) : absolute_deadline(clock, time);
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

bool futex_syscall(const Argument (&a)[6], long* result) {
    if (futex(result, a[0], a[1], a[2], a[3], a[5])) return true;
    note("futex operation 0x%lx is left to the host", a[1].value);
    return false;
}

}  // namespace puckloop::shim
