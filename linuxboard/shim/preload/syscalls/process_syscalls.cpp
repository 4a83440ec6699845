// System calls for processes: made, replaced, ended, named. What nobody can conduct is refused by name.

#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/processes/namespace_calls.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/syscalls/syscalls.h"

#include <linux/sched.h>
#include <sched.h>
#include <sys/msg.h>
#include <sys/random.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>

extern "C" int pidfd_open(pid_t process, unsigned flags) noexcept;

namespace puckloop::shim {

namespace {
long clone3(const void* argument, std::size_t size) {
    clone_args wanted{};
    if (size < CLONE_ARGS_SIZE_VER0) return failed(EINVAL);
    if (!copy_from_program(&wanted, argument, std::min(size, sizeof wanted))) return -1;
    const auto pointer = [](std::uint64_t number) { return reinterpret_cast<void*>(number); };
    return clone_process("syscall(SYS_clone3)", wanted.flags, static_cast<int>(wanted.exit_signal),
                         pointer(wanted.stack), pointer(wanted.parent_tid), pointer(wanted.child_tid));
}
/// The kernel's answer counts from 40 (the least nice) down to 1.
long kernels_priority(int which, pid_t who) {
    errno = 0;
    const int level = getpriority(static_cast<__priority_which_t>(which), static_cast<id_t>(who));
    return level == -1 && errno != 0 ? -1 : 20 - level;
}

/// Which argument of a call is a process number; -1: none. Calls that this library takes over are not here.
int process_argument(long number, const Argument (&a)[6]) {
    constexpr int kIoprioProcess = 1;
    switch (number) {
    case SYS_sched_getscheduler:
    case SYS_sched_getparam:
    case SYS_sched_rr_get_interval:
    case SYS_sched_getaffinity:
    case SYS_sched_getattr:
    case SYS_sched_setattr:
    case SYS_process_vm_readv:
    case SYS_process_vm_writev:
    case SYS_move_pages:
    case SYS_migrate_pages:
    case SYS_get_robust_list:
    case SYS_kcmp:
        return 0;
    case SYS_ioprio_get:
    case SYS_ioprio_set:
        return a[0].value == kIoprioProcess ? 1 : -1;
    case SYS_perf_event_open:
        return a[1].value > 0 ? 1 : -1;
    default:
        return -1;
    }
}

/// Makes such a call with the host's number.
bool of_host_process(long number, const Argument (&a)[6], long* result) {
    const int which = process_argument(number, a);
    if (which < 0) return false;
    long values[6];
    for (std::size_t i = 0; i < 6; ++i)
        values[i] = a[i].value;
    const int last = number == SYS_kcmp ? 1 : which;
    for (int i = which; i <= last; ++i) {
        const pid_t host = host_process(a[i]);
        if (host < 0) {
            *result = -1;
            return true;
        }
        values[i] = host;
    }
    *result = host_call(number, values[0], values[1], values[2], values[3], values[4], values[5]);
    return true;
}
}  // namespace

bool process_syscall(long number, const Argument (&a)[6], long* result) {
    switch (number) {
        PUCKLOOP_SYSCALL(msgctl, msgctl(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(shmctl, shmctl(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(semctl, semctl(a[0], a[1], a[2], a[3].value));
#if defined(__x86_64__)
        PUCKLOOP_SYSCALL(getpgrp, getpgrp());
        PUCKLOOP_SYSCALL(getrlimit, getrlimit(static_cast<__rlimit_resource_t>(a[0].value), a[1]));
        PUCKLOOP_SYSCALL(setrlimit, setrlimit(static_cast<__rlimit_resource_t>(a[0].value), a[1]));
#endif
        PUCKLOOP_SYSCALL(getrandom, getrandom(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(getpid, getpid());
        PUCKLOOP_SYSCALL(getppid, getppid());
        PUCKLOOP_SYSCALL(gettid, gettid());
        PUCKLOOP_SYSCALL(getpgid, getpgid(a[0]));
        PUCKLOOP_SYSCALL(setpgid, setpgid(a[0], a[1]));
        PUCKLOOP_SYSCALL(getsid, getsid(a[0]));
        PUCKLOOP_SYSCALL(setsid, setsid());
        PUCKLOOP_SYSCALL(uname, uname(a[0]));
        PUCKLOOP_SYSCALL(prlimit64, prlimit64(a[0], static_cast<__rlimit_resource>(a[1].value), a[2], a[3]));
        PUCKLOOP_SYSCALL(setpriority, setpriority(static_cast<__priority_which_t>(a[0].value), a[1], a[2]));
        PUCKLOOP_SYSCALL(getpriority, kernels_priority(a[0], a[1]));
        PUCKLOOP_SYSCALL(sched_setparam, sched_setparam(a[0], a[1]));
        PUCKLOOP_SYSCALL(pidfd_open, pidfd_open(a[0], a[1]));
        PUCKLOOP_SYSCALL(sched_setscheduler, sched_setscheduler(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(sched_setaffinity, sched_setaffinity(a[0], a[1], a[2]));
        PUCKLOOP_SYSCALL(wait4, wait4(a[0], a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(waitid, waitid(static_cast<idtype_t>(a[0].value), a[1], a[2], a[3]));
        PUCKLOOP_SYSCALL(execve, execve(a[0], a[1], a[2]));
#if defined(__x86_64__)
    case SYS_fork:
    case SYS_vfork:
        *result = fork_plainly();
        return true;
    case SYS_clone:  // the order of the last arguments is this processor's
        *result = clone_process("syscall(SYS_clone)",
                                static_cast<std::uint64_t>(a[0].value) & ~std::uint64_t{CSIGNAL},
                                static_cast<int>(a[0].value & CSIGNAL), a[1], a[2], a[3]);
        return true;
#else
    case SYS_clone:
        *result = clone_process("syscall(SYS_clone)",
                                static_cast<std::uint64_t>(a[0].value) & ~std::uint64_t{CSIGNAL},
                                static_cast<int>(a[0].value & CSIGNAL), a[1], a[2], a[4]);
        return true;
#endif
    case SYS_clone3:
        *result = clone3(a[0], a[1]);
        return true;
    case SYS_execveat:
        refuse_call("syscall(SYS_execveat)", "which puts another program in its place past the library");
        return true;
    case SYS_exit_group:
        _exit(a[0]);
    case SYS_exit:
        if (thread_count() == 1) _exit(a[0]);
        return false;
    case SYS_unshare:
        refuse_namespaces("syscall(SYS_unshare)", static_cast<std::uint64_t>(a[0].value));
        return false;
    case SYS_setns:
        refuse_joining("syscall(SYS_setns)");
        return true;
    case SYS_seccomp: {
        constexpr long kSetModeFilter = 1;  // and 0, strict; the others ask
        if (a[0].value <= kSetModeFilter) refuse_filter("syscall(SYS_seccomp)");
        return false;
    }
    case SYS_prctl:
        return own_prctl(a[0].value, a[1].value, result);
    case SYS_ptrace:
        refuse_call("syscall(SYS_ptrace)", "with which debuggers stop processes outside of simulated time");
        return true;
    case SYS_io_uring_setup:
    case SYS_io_uring_enter:
    case SYS_io_uring_register:
        refuse_call("syscall(SYS_io_uring_setup)", "whose input and output pass by every call");
        return true;
    default:
        return of_host_process(number, a, result);
    }
}

}  // namespace puckloop::shim
