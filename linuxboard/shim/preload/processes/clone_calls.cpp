// Processes made otherwise than by fork(): what is a plain copy is conducted as fork() is, what shares memory
// or descriptors with its parent is refused by name, since nobody could conduct it.

#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <linux/sched.h>
#include <sched.h>
#include <signal.h>
#include <sys/ptrace.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>

extern "C" pid_t _Fork(void) noexcept;

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
constexpr std::uint64_t kNumbers = CLONE_PARENT_SETTID | CLONE_CHILD_SETTID | CLONE_CHILD_CLEARTID;
constexpr std::uint64_t kAsVfork = CLONE_VM | CLONE_VFORK;

/// A copy of the process, perhaps one of vfork(), that sends SIGCHLD at its end.
bool is_plain_copy(std::uint64_t flags, int signal) {
    const bool borrows = (flags & CLONE_VM) != 0 && (flags & CLONE_VFORK) == 0;
    return signal == SIGCHLD && !borrows && (flags & ~(kNumbers | kAsVfork)) == 0;
}

pid_t copy_process(std::uint64_t flags, void* parent_number, void* child_number) {
    const pid_t child = fork_plainly();
    if (child < 0) return child;
    const pid_t number = child == 0 ? own().number : child;
    if (child == 0 && (flags & CLONE_CHILD_SETTID) != 0) put_to_program(child_number, number);
    if ((flags & CLONE_PARENT_SETTID) != 0) put_to_program(parent_number, number);
    return child;
}
}  // namespace

void refuse_call(const char* name, const char* why) {
    char text[200];
    std::snprintf(text, sizeof text, "the program calls %s, %s: not run any further", name, why);
    note("%s", text);
    announce_exit(wire::kRefusedStatus);
    refuse(text);
}

pid_t clone_process(const char* name, std::uint64_t flags, int signal, void* stack, void* parent_number,
                    void* child_number) {
    if (stack != nullptr || !is_plain_copy(flags, signal))
        refuse_call(name, "which makes a process or a thread that nobody can conduct");
    return copy_process(flags, parent_number, child_number);
}

}  // namespace puckloop::shim

SHIM_EXPORT pid_t _Fork() noexcept {
    return active() ? fork_plainly() : REAL(_Fork)();
}

SHIM_EXPORT int clone(int (*function)(void*), void* stack, int flags, void* argument, ...) noexcept {
    std::va_list list;
    va_start(list, argument);
    void* const parent_number = va_arg(list, void*);
    void* const tls = va_arg(list, void*);
    void* const child_number = va_arg(list, void*);
    va_end(list);
    if (!active()) return REAL(clone)(function, stack, flags, argument, parent_number, tls, child_number);
    if (function == nullptr || stack == nullptr) return fail(EINVAL);
    // The copy has a stack of its own already: the one that it was given is left alone.
    const pid_t child = clone_process("clone()", static_cast<unsigned>(flags) & ~unsigned{CSIGNAL},
                                      flags & CSIGNAL, nullptr, parent_number, child_number);
    if (child == 0) _exit(function(argument));
    return child;
}

SHIM_EXPORT long ptrace(__ptrace_request request, ...) noexcept {
    std::va_list list;
    va_start(list, request);
    long a[3];
    for (long& argument : a)
        argument = va_arg(list, long);
    va_end(list);
    if (active()) refuse_call("ptrace()", "with which debuggers stop processes outside of simulated time");
    return REAL(ptrace)(request, a[0], a[1], a[2]);
}
