// System calls for signals. The kernel's sets of signals have 8 bytes, the C library's more.

#include "linuxboard/shim/preload/host/kernel_signals.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/syscalls/syscalls.h"

#include <pthread.h>
#include <signal.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>

namespace puckloop::shim {

namespace {
/// The handler returns by the C library's code, whatever the program has of its own.
long set_action(int number, const void* theirs, void* before, std::size_t size) {
    if (size != kKernelSetSize) return failed(EINVAL);
    struct sigaction action {
    }, old{};
    if (theirs != nullptr) {
        KernelAction wanted{};
        if (!get_from_program(wanted, theirs)) return -1;
        action.sa_handler = reinterpret_cast<sighandler_t>(wanted.handler);
        action.sa_flags = static_cast<int>(wanted.flags & ~kHasRestorer);
        action.sa_mask = set_of_kernel(wanted.mask);
    }
    if (sigaction(number, theirs != nullptr ? &action : nullptr, &old) < 0) return -1;
    if (before == nullptr) return 0;
    KernelAction shown{};
    shown.handler = reinterpret_cast<void*>(old.sa_handler);
    shown.flags = static_cast<unsigned>(old.sa_flags);
    shown.mask = kernel_mask(old.sa_mask);
    return put_to_program(before, shown) ? 0 : -1;
}

long set_mask(int how, const void* theirs, void* before, std::size_t size) {
    if (size != kKernelSetSize) return failed(EINVAL);
    std::uint64_t mask = 0;
    if (theirs != nullptr && !get_from_program(mask, theirs)) return -1;
    const sigset_t set = set_of_kernel(mask);
    sigset_t old;
    sigemptyset(&old);
    if (const int error = pthread_sigmask(how, theirs != nullptr ? &set : nullptr, &old))
        return failed(error);
    return before == nullptr || put_to_program(before, kernel_mask(old)) ? 0 : -1;
}

long suspend(const void* theirs, std::size_t size) {
    std::uint64_t mask = 0;
    if (size != kKernelSetSize) return failed(EINVAL);
    if (!get_from_program(mask, theirs)) return -1;
    const sigset_t set = set_of_kernel(mask);
    return sigsuspend(&set);
}

long wait_for_signal(const Argument (&a)[6]) {
    std::uint64_t mask = 0;
    if (a[3].value != static_cast<long>(kKernelSetSize)) return failed(EINVAL);
    if (!get_from_program(mask, a[0])) return -1;
    const sigset_t set = set_of_kernel(mask);
    return sigtimedwait(&set, a[1], a[2]);
}

/// What sigqueue() makes: number, code, value. A code that only the kernel gives is not for others.
long queue_signal(pid_t process, int number, const void* theirs) {
    siginfo_t info{};
    if (!get_from_program(info, theirs)) return -1;
    return sigqueue(process, number, info.si_value);
}
}  // namespace

bool signal_syscall(long number, const Argument (&a)[6], long* result) {
    switch (number) {
#if defined(__x86_64__)
        PUCKLOOP_SYSCALL(pause, pause());
#endif
        PUCKLOOP_SYSCALL(kill, kill(a[0], a[1]));
        PUCKLOOP_SYSCALL(rt_sigaction, set_action(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(rt_sigprocmask, set_mask(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(rt_sigsuspend, suspend(a[0], a[1]));
        PUCKLOOP_SYSCALL(rt_sigtimedwait, wait_for_signal(a));
        PUCKLOOP_SYSCALL(tgkill, tgkill(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(tkill, signal_thread(-1, a[0], a[1]));
        PUCKLOOP_SYSCALL(rt_sigqueueinfo, queue_signal(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(rt_tgsigqueueinfo, tgkill(a[0], a[1], a[2]));
    default:
        return false;
    }
}

}  // namespace puckloop::shim
