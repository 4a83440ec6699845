// Who the program is: host name and process number, the same in every run. A process number often seeds
// random numbers, so it is a fixed one; calls that take one accept it.

#include "linuxboard/shim/preload/host.h"
#include "linuxboard/shim/preload/real.h"
#include "linuxboard/shim/preload/scheduler.h"

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
constexpr pid_t kProcess = 1000;

pid_t host_process(pid_t given) {
    return active() && given == kProcess ? static_cast<pid_t>(host_call(SYS_getpid)) : given;
}
}  // namespace

SHIM_EXPORT pid_t getpid() noexcept {
    return active() ? kProcess : REAL(getpid)();
}

/// As if started by the first process.
SHIM_EXPORT pid_t getppid() noexcept {
    constexpr pid_t kInit = 1;
    return active() ? kInit : REAL(getppid)();
}

SHIM_EXPORT pid_t gettid() noexcept {
    return active() ? kProcess + static_cast<pid_t>(self()->index) : REAL(gettid)();
}

SHIM_EXPORT int kill(pid_t process, int number) noexcept {
    return REAL(kill)(host_process(process), number);
}

SHIM_EXPORT int sched_setscheduler(pid_t process, int policy, const sched_param* parameters) noexcept {
    // One thread runs at a time whatever its priority; the host's is not changed.
    if (active() && (process == 0 || process == kProcess)) return 0;
    return REAL(sched_setscheduler)(process, policy, parameters);
}

SHIM_EXPORT int sched_setaffinity(pid_t process, size_t size, const cpu_set_t* processors) noexcept {
    return REAL(sched_setaffinity)(host_process(process), size, processors);
}

SHIM_EXPORT int setpriority(__priority_which_t which, id_t who, int priority) noexcept {
    if (active() && which == PRIO_PROCESS && (who == 0 || who == kProcess)) return 0;
    return REAL(setpriority)(which, who, priority);
}

SHIM_EXPORT pid_t getpgid(pid_t process) noexcept {
    return REAL(getpgid)(host_process(process));
}

SHIM_EXPORT pid_t getsid(pid_t process) noexcept {
    return REAL(getsid)(host_process(process));
}

SHIM_EXPORT int gethostname(char* name, size_t size) noexcept {
    if (!active()) return REAL(gethostname)(name, size);
    const char* host = page().host_name;
    if (std::strlen(host) >= size) {
        errno = ENAMETOOLONG;
        return -1;
    }
    std::strcpy(name, host);
    return 0;
}

SHIM_EXPORT int uname(utsname* names) noexcept {
    const int result = REAL(uname)(names);
    if (result == 0 && active()) std::strncpy(names->nodename, page().host_name, sizeof names->nodename - 1);
    return result;
}
