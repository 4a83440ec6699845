// syscall(): what has a function that is taken over goes to that function; what would escape simulated time
// is refused by name; the rest is the host's.

#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/syscalls/syscalls.h"

#include <sys/syscall.h>
#include <unistd.h>

#include <cstdarg>

using namespace puckloop::shim;

namespace {
bool taken_over(long number, const Argument (&a)[6], long* result) {
    if (number == SYS_futex) return futex_syscall(a, result);
    return file_syscall(number, a, result) || path_syscall(number, a, result) ||
           time_syscall(number, a, result) || signal_syscall(number, a, result) ||
           process_syscall(number, a, result);
}
}  // namespace

SHIM_EXPORT long syscall(long number, ...) noexcept {
    std::va_list list;
    va_start(list, number);
    Argument a[6];
    for (Argument& argument : a)
        argument.value = va_arg(list, long);
    va_end(list);
    long result = 0;
    if (active() && taken_over(number, a, &result)) return result;
    return REAL(syscall)(number, a[0].value, a[1].value, a[2].value, a[3].value, a[4].value, a[5].value);
}
