// Who the program is: host name and process numbers, the same in every run. A process number often seeds
// random numbers, so they count from a fixed one; calls that take one accept those of the program's
// processes.

#include "linuxboard/shim/preload/calls.h"
#include "linuxboard/shim/preload/host.h"
#include "linuxboard/shim/preload/link.h"
#include "linuxboard/shim/preload/program_memory.h"
#include "linuxboard/shim/preload/real.h"
#include "linuxboard/shim/preload/threads/scheduler.h"

#include <sched.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

using namespace puckloop::shim;

namespace {
/// Thread numbers beside the first thread's, which is the process's, are far from all process numbers.
constexpr pid_t kFirstThread = 100'000;
constexpr pid_t kThreadsOfProcess = 1024;

bool is_own(pid_t process) {
    return process == 0 || process == own().number;
}

/// The host's number for a process of the program; 0 for one that is none.
pid_t host_process(pid_t given) {
    if (!active() || given == 0) return given;
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free && entry.number == given) return entry.host;
    return -1;
}

/// Sends `number` to the processes that `chosen` picks; false if there is none.
template <typename Choice>
bool send_to(int number, Choice chosen) {
    bool found = false;
    bool self_too = false;
    for (std::uint32_t slot = 0; slot < wire::kMaximumProcesses; ++slot) {
        const wire::ProcessEntry& entry = page().processes[slot];
        if (entry.state == wire::ProcessEntry::Free || !chosen(entry)) continue;
        found = true;
        if (slot == own_slot()) {
            self_too = true;
        } else if (number != 0 && entry.state == wire::ProcessEntry::Alive) {
            wire::Request request;
            request.op = wire::Op::Kill;
            request.a = slot;
            request.b = static_cast<std::uint32_t>(number);
            device_call(request);
        }
    }
    if (self_too && number != 0) REAL(kill)(static_cast<pid_t>(host_call(SYS_getpid)), number);
    return found;
}
}  // namespace

SHIM_EXPORT pid_t getpid() noexcept {
    return active() ? own().number : REAL(getpid)();
}

/// The program's first process is as if started by the system's.
SHIM_EXPORT pid_t getppid() noexcept {
    constexpr pid_t kInit = 1;
    if (!active()) return REAL(getppid)();
    return own().parent == wire::kNoParent ? kInit : page().processes[own().parent].number;
}

namespace puckloop::shim {
pid_t thread_number(std::uint32_t index) {
    return index == 0 ? own().number
                      : kFirstThread + kThreadsOfProcess * (own().number - wire::kFirstProcess) +
                            static_cast<pid_t>(index);
}
}  // namespace puckloop::shim

SHIM_EXPORT pid_t gettid() noexcept {
    return active() ? thread_number(self()->index) : REAL(gettid)();
}

SHIM_EXPORT int kill(pid_t process, int number) noexcept {
    if (!active()) return REAL(kill)(process, number);
    if (number < 0 || number >= NSIG) {
        errno = EINVAL;
        return -1;
    }
    if (number == SIGSTOP || number == SIGTSTP) note("stopping a process has no effect");
    const pid_t group = process == 0 ? own().group : -process;
    const bool found = send_to(number, [&](const wire::ProcessEntry& entry) {
        if (process > 0) return entry.number == process;
        return process == -1 ? &entry != &own() : entry.group == group;
    });
    if (found) return 0;
    errno = ESRCH;  // the host's own processes are out of reach
    return -1;
}

SHIM_EXPORT int killpg(pid_t group, int number) noexcept {
    return active() ? kill(group == 0 ? 0 : -group, number) : REAL(killpg)(group, number);
}

SHIM_EXPORT int setpgid(pid_t process, pid_t group) noexcept {
    if (!active()) return REAL(setpgid)(process, group);
    for (wire::ProcessEntry& entry : page().processes) {
        if (entry.state != wire::ProcessEntry::Alive ||
            entry.number != (process == 0 ? own().number : process))
            continue;
        entry.group = group == 0 ? entry.number : group;
        return 0;
    }
    errno = ESRCH;
    return -1;
}

SHIM_EXPORT int setpgrp() noexcept {
    return active() ? setpgid(0, 0) : REAL(setpgrp)();
}

SHIM_EXPORT pid_t setsid() noexcept {
    if (!active()) return REAL(setsid)();
    return own().group = own().number;
}

SHIM_EXPORT pid_t getpgrp() noexcept {
    return active() ? own().group : REAL(getpgrp)();
}

SHIM_EXPORT int sched_setscheduler(pid_t process, int policy, const sched_param* parameters) noexcept {
    // One thread runs at a time whatever its priority; the host's is not changed.
    if (active() && is_own(process)) return 0;
    return REAL(sched_setscheduler)(process, policy, parameters);
}

SHIM_EXPORT int sched_setaffinity(pid_t process, size_t size, const cpu_set_t* processors) noexcept {
    return REAL(sched_setaffinity)(host_process(process), size, processors);
}

SHIM_EXPORT int setpriority(__priority_which_t which, id_t who, int priority) noexcept {
    if (active() && which == PRIO_PROCESS && is_own(static_cast<pid_t>(who))) return 0;
    return REAL(setpriority)(which, who, priority);
}

SHIM_EXPORT pid_t getpgid(pid_t process) noexcept {
    if (!active()) return REAL(getpgid)(process);
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free &&
            entry.number == (process == 0 ? own().number : process))
            return entry.group;
    errno = ESRCH;
    return -1;
}

SHIM_EXPORT pid_t getsid(pid_t process) noexcept {
    return active() ? getpgid(process) : REAL(getsid)(process);
}

SHIM_EXPORT int gethostname(char* name, size_t size) noexcept {
    if (!active()) return REAL(gethostname)(name, size);
    const char* host = page().host_name;
    if (std::strlen(host) >= size) {
        errno = ENAMETOOLONG;
        return -1;
    }
    return copy_to_program(name, host, std::strlen(host) + 1) ? 0 : -1;
}

SHIM_EXPORT int uname(utsname* names) noexcept {
    const int result = REAL(uname)(names);
    if (result == 0 && active()) std::strncpy(names->nodename, page().host_name, sizeof names->nodename - 1);
    return result;
}
