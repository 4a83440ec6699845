// Ways out of the run that a process may take for itself and its children: namespaces, filters of system
// calls, another way for its own instructions. What would leave simulated time, or take away a call that the
// library needs, is refused by name.

#include "linuxboard/shim/preload/processes/namespace_calls.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <linux/sched.h>
#include <sched.h>
#include <signal.h>
#include <sys/prctl.h>

#include <cerrno>
#include <cstdarg>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
constexpr const char* kNamespace = "whose processes nobody can conduct in a namespace of their own";
constexpr const char* kFilter = "which takes calls away that the library needs";
constexpr long kSyscallUserDispatch = 59;  // PR_SET_SYSCALL_USER_DISPATCH; older headers lack it
constexpr std::uint64_t kNamespaces = CLONE_NEWCGROUP | CLONE_NEWIPC | CLONE_NEWNET | CLONE_NEWNS |
                                      CLONE_NEWPID | CLONE_NEWTIME | CLONE_NEWUSER | CLONE_NEWUTS;

/// Of the program's own, at the end of its parent. The kernel's is the library's: the node's end.
int death_signal = 0;

int set_death_signal(long number) {
    if (number < 0 || number > SIGRTMAX) return fail(EINVAL);
    if (number != 0) note("a signal at the parent's end (PR_SET_PDEATHSIG) is stored, not sent");
    death_signal = static_cast<int>(number);
    return 0;
}
}  // namespace

void refuse_namespaces(const char* name, std::uint64_t flags) {
    if ((flags & kNamespaces) != 0) refuse_call(name, kNamespace);
}

void refuse_joining(const char* name) {
    refuse_call(name, kNamespace);
}

void refuse_filter(const char* name) {
    refuse_call(name, kFilter);
}

bool own_prctl(long option, long argument, long* result) {
    switch (option) {
    case PR_SET_SECCOMP:
        refuse_filter("prctl(PR_SET_SECCOMP)");
        return true;
    case kSyscallUserDispatch:
        refuse_filter("prctl(PR_SET_SYSCALL_USER_DISPATCH)");
        return true;
    case PR_SET_PDEATHSIG:
        *result = set_death_signal(argument);
        return true;
    case PR_GET_PDEATHSIG:
        *result = put_to_program(reinterpret_cast<int*>(argument), death_signal) ? 0 : -1;
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::shim

SHIM_EXPORT int unshare(int flags) noexcept {
    if (active()) refuse_namespaces("unshare()", static_cast<unsigned>(flags));
    return REAL(unshare)(flags);
}

SHIM_EXPORT int setns(int fd, int kind) noexcept {
    if (active()) refuse_joining("setns()");
    return REAL(setns)(fd, kind);
}

SHIM_EXPORT int prctl(int option, ...) noexcept {
    std::va_list list;
    va_start(list, option);
    long a[4];
    for (long& argument : a)
        argument = va_arg(list, long);
    va_end(list);
    long result = 0;
    if (active() && own_prctl(option, a[0], &result)) return static_cast<int>(result);
    return REAL(prctl)(option, a[0], a[1], a[2], a[3]);
}
