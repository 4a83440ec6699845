// Calls of a process number, beside kill() and its like (identity_calls.cpp): the host gets its own number
// for the program's processes, and none of any other. Priorities and scheduling policies are kept here: one
// thread runs at a time whatever they are.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sched.h>
#include <signal.h>
#include <sys/ipc.h>
#include <sys/msg.h>
#include <sys/resource.h>
#include <sys/sem.h>
#include <sys/shm.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>

extern "C" int pidfd_open(pid_t process, unsigned flags) noexcept;

using namespace puckloop::shim;

namespace {
constexpr int kNicest = 19, kLeastNice = -20;
int nice_level = 0;  ///< of this process; children inherit it

/// Makes the call with the host's number, or fails with ESRCH.
template <typename Call>
auto with_host_number(pid_t process, Call call) -> decltype(call(process)) {
    const pid_t host = host_process(process);
    return host < 0 ? static_cast<decltype(call(process))>(-1) : call(host);
}

bool is_own(pid_t process) {
    return process == 0 || process == own().number;
}

/// Whether a call for `who` means anybody: a process, a group of the program's, the program's user.
bool is_known(int which, pid_t who) {
    if (which == PRIO_USER) return who == 0 || static_cast<uid_t>(who) == getuid();
    for (const wire::ProcessEntry& entry : page().processes) {
        if (entry.state == wire::ProcessEntry::Free) continue;
        if (which == PRIO_PROCESS && (who == 0 || entry.number == who)) return true;
        if (which == PRIO_PGRP && entry.group == (who == 0 ? own().group : who)) return true;
    }
    return false;
}

bool check_priority(int which, pid_t who) {
    if (which < PRIO_PROCESS || which > PRIO_USER) {
        errno = EINVAL;
        return false;
    }
    if (is_known(which, who)) return true;
    errno = ESRCH;
    return false;
}
}  // namespace

namespace puckloop::shim {
pid_t host_process(pid_t given) {
    if (!active() || given == 0) return given;
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free && entry.number == given) return entry.host;
    return fail(ESRCH);
}

pid_t program_process(pid_t host) {
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free && entry.host == host) return entry.number;
    return 0;
}
}  // namespace puckloop::shim

SHIM_EXPORT int setpriority(__priority_which_t which, id_t who, int priority) noexcept {
    if (!active()) return REAL(setpriority)(which, who, priority);
    if (!check_priority(static_cast<int>(which), static_cast<pid_t>(who))) return -1;
    const int level = std::clamp(priority, kLeastNice, kNicest);
    if (level < nice_level && geteuid() != 0) return fail(EACCES);
    if (which != PRIO_PROCESS || is_own(static_cast<pid_t>(who))) nice_level = level;
    return 0;
}

SHIM_EXPORT int getpriority(__priority_which_t which, id_t who) noexcept {
    if (!active()) return REAL(getpriority)(which, who);
    if (!check_priority(static_cast<int>(which), static_cast<pid_t>(who))) return -1;
    errno = 0;
    return which != PRIO_PROCESS || is_own(static_cast<pid_t>(who)) ? nice_level : 0;
}

SHIM_EXPORT int nice(int increment) noexcept {
    if (!active()) return REAL(nice)(increment);
    if (increment < 0 && geteuid() != 0) return fail(EPERM);
    nice_level =
        std::clamp(nice_level + std::clamp(increment, -2 * kNicest, 2 * kNicest), kLeastNice, kNicest);
    return nice_level;
}

SHIM_EXPORT int sched_setscheduler(pid_t process, int policy, const sched_param* parameters) noexcept {
    if (!active()) return REAL(sched_setscheduler)(process, policy, parameters);
    return host_process(process) < 0 ? -1 : 0;
}

SHIM_EXPORT int sched_setparam(pid_t process, const sched_param* parameters) noexcept {
    if (!active()) return REAL(sched_setparam)(process, parameters);
    return host_process(process) < 0 ? -1 : 0;
}

SHIM_EXPORT int sched_getscheduler(pid_t process) noexcept {
    return with_host_number(process, [](pid_t host) { return REAL(sched_getscheduler)(host); });
}

SHIM_EXPORT int sched_getparam(pid_t process, sched_param* parameters) noexcept {
    return with_host_number(process, [&](pid_t host) { return REAL(sched_getparam)(host, parameters); });
}

SHIM_EXPORT int sched_rr_get_interval(pid_t process, timespec* interval) noexcept {
    return with_host_number(process, [&](pid_t host) { return REAL(sched_rr_get_interval)(host, interval); });
}

SHIM_EXPORT int sched_setaffinity(pid_t process, size_t size, const cpu_set_t* processors) noexcept {
    return with_host_number(process,
                            [&](pid_t host) { return REAL(sched_setaffinity)(host, size, processors); });
}

SHIM_EXPORT int sched_getaffinity(pid_t process, size_t size, cpu_set_t* processors) noexcept {
    return with_host_number(process,
                            [&](pid_t host) { return REAL(sched_getaffinity)(host, size, processors); });
}

SHIM_EXPORT int pidfd_open(pid_t process, unsigned flags) noexcept {
    if (process == 0) return fail(EINVAL);
    return with_host_number(
        process, [&](pid_t host) { return static_cast<int>(host_call(SYS_pidfd_open, host, flags)); });
}

SHIM_EXPORT ssize_t process_vm_readv(pid_t process, const iovec* local, unsigned long parts,
                                     const iovec* remote, unsigned long remote_parts,
                                     unsigned long flags) noexcept {
    return with_host_number(process, [&](pid_t host) {
        return REAL(process_vm_readv)(host, local, parts, remote, remote_parts, flags);
    });
}

SHIM_EXPORT ssize_t process_vm_writev(pid_t process, const iovec* local, unsigned long parts,
                                      const iovec* remote, unsigned long remote_parts,
                                      unsigned long flags) noexcept {
    return with_host_number(process, [&](pid_t host) {
        return REAL(process_vm_writev)(host, local, parts, remote, remote_parts, flags);
    });
}

namespace {
template <typename Status>
bool is_shown(int result, int command, const Status* status) {
    return active() && result >= 0 && status != nullptr && command == IPC_STAT;
}
}  // namespace

// Who was last at a queue, a semaphore or shared memory.
SHIM_EXPORT int msgctl(int queue, int command, msqid_ds* status) noexcept {
    const int result = REAL(msgctl)(queue, command, status);
    if (is_shown(result, command, status)) {
        status->msg_lspid = program_process(status->msg_lspid);
        status->msg_lrpid = program_process(status->msg_lrpid);
    }
    return result;
}

SHIM_EXPORT int shmctl(int memory, int command, shmid_ds* status) noexcept {
    const int result = REAL(shmctl)(memory, command, status);
    if (is_shown(result, command, status)) {
        status->shm_cpid = program_process(status->shm_cpid);
        status->shm_lpid = program_process(status->shm_lpid);
    }
    return result;
}

SHIM_EXPORT int semctl(int set, int number, int command, ...) noexcept {
    std::va_list arguments;
    va_start(arguments, command);
    const long argument = va_arg(arguments, long);  // of a union, or none
    va_end(arguments);
    const int result = REAL(semctl)(set, number, command, argument);
    return active() && command == GETPID && result > 0 ? program_process(result) : result;
}

SHIM_EXPORT int sigqueue(pid_t process, int number, const sigval value) noexcept {
    if (!active()) return REAL(sigqueue)(process, number, value);
    if (number < 0 || number >= NSIG) return fail(EINVAL);
    if (process == own().number)
        return REAL(sigqueue)(static_cast<pid_t>(host_call(SYS_getpid)), number, value);
    if (process <= 0 || host_process(process) < 0) return fail(ESRCH);
    if (number != 0) note("the value of sigqueue() does not reach another process");
    return kill(process, number);
}

SHIM_EXPORT int tgkill(pid_t process, pid_t thread, int number) {
    if (!active()) return static_cast<int>(host_call(SYS_tgkill, process, thread, number));
    if (process <= 0 || thread <= 0) return fail(EINVAL);
    return signal_thread(process, thread, number);
}
