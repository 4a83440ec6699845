// Who the program is: host name and process numbers, the same in every run. A process number often seeds
// random numbers, so they count from a fixed one; calls that take one accept those of the program's
// processes.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <pthread.h>
#include <signal.h>
#include <sys/syscall.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

using namespace puckloop::shim;

namespace {
/// A signal that would stop this process, and with it simulated time.
bool stops_by_default(int number) {
    if (number != SIGTSTP && number != SIGTTIN && number != SIGTTOU) return number == SIGSTOP;
    struct sigaction action {};
    if (sigaction(number, nullptr, &action) != 0 || action.sa_handler != SIG_DFL) return false;
    note("stopping a process has no effect");
    return true;
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
        if (number == SIGSTOP) continue;  // it would stop the whole board
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
    if (self_too && number != 0 && !stops_by_default(number)) {
        if (thread_count() > 1) {
            signal_process(number);
        } else {
            REAL(kill)(static_cast<pid_t>(host_call(SYS_getpid)), number);
        }
    }
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
int signal_thread(pid_t process, pid_t thread, int number) {
    if (number < 0 || number >= NSIG) return fail(EINVAL);
    for (std::size_t i = 0; (process < 0 || process == own().number) && i < thread_count(); ++i) {
        const Thread* candidate = thread_at(i);
        if (candidate == nullptr || !candidate->has_handle || thread_number(candidate->index) != thread)
            continue;
        errno = pthread_kill(candidate->handle, number);
        return errno == 0 ? 0 : -1;
    }
    // Of another process only the first thread is known: it is the process.
    if (thread > 0 && (process < 0 || process == thread)) return kill(thread, number);
    return fail(ESRCH);
}
}  // namespace puckloop::shim

/// As the C library's: of a thread that has ended but was not joined it is a success without effect.
SHIM_EXPORT int pthread_kill(pthread_t handle, int number) noexcept {
    Thread* thread = active() ? find_thread(handle) : nullptr;
    if (thread == nullptr || thread == self() || number <= 0 || number >= NSIG)
        return REAL(pthread_kill)(handle, number);
    charge(page().charges.yield);
    if (number == SIGKILL) return kill(own().number, number) == 0 ? 0 : errno;
    if (thread->state != Thread::State::Finished && !stops_by_default(number)) direct_signal(thread, number);
    return 0;
}
SHIM_EXPORT int pthread_sigqueue(pthread_t handle, int number, const sigval value) noexcept {
    const Thread* thread = active() ? find_thread(handle) : nullptr;
    if (thread == nullptr || thread == self()) return REAL(pthread_sigqueue)(handle, number, value);
    if (number != 0) note("the value of pthread_sigqueue() does not reach another thread");
    return pthread_kill(handle, number);
}

SHIM_EXPORT pid_t gettid() noexcept {
    return active() ? thread_number(self()->index) : REAL(gettid)();
}

SHIM_EXPORT int kill(pid_t process, int number) noexcept {
    if (!active()) return REAL(kill)(process, number);
    if (number < 0 || number >= NSIG) return fail(EINVAL);
    if (number == SIGSTOP) note("stopping a process has no effect");
    const pid_t group = process == 0 ? own().group : -process;
    const bool found = send_to(number, [&](const wire::ProcessEntry& entry) {
        if (process > 0) return entry.number == process;
        return process == -1 ? &entry != &own() : entry.group == group;
    });
    if (found) return 0;
    return fail(ESRCH);  // the host's own processes are out of reach
}

SHIM_EXPORT int raise(int number) noexcept {
    if (!active()) return REAL(raise)(number);
    if (number == SIGSTOP) note("stopping a process has no effect");
    return number > 0 && number < NSIG && stops_by_default(number) ? 0 : REAL(raise)(number);
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
    return fail(ESRCH);
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

SHIM_EXPORT pid_t getpgid(pid_t process) noexcept {
    if (!active()) return REAL(getpgid)(process);
    for (const wire::ProcessEntry& entry : page().processes)
        if (entry.state != wire::ProcessEntry::Free &&
            entry.number == (process == 0 ? own().number : process))
            return entry.group;
    return fail(ESRCH);
}

SHIM_EXPORT pid_t getsid(pid_t process) noexcept {
    return active() ? getpgid(process) : REAL(getsid)(process);
}

SHIM_EXPORT int gethostname(char* name, size_t size) noexcept {
    if (!active()) return REAL(gethostname)(name, size);
    const char* host = page().host_name;
    if (std::strlen(host) >= size) return fail(ENAMETOOLONG);
    return copy_to_program(name, host, std::strlen(host) + 1) ? 0 : -1;
}

SHIM_EXPORT int uname(utsname* names) noexcept {
    const int result = REAL(uname)(names);
    if (result == 0 && active()) std::strncpy(names->nodename, page().host_name, sizeof names->nodename - 1);
    return result;
}
