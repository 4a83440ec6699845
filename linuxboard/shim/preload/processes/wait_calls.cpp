// Waiting for children, in simulated time.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <pthread.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <cerrno>
#include <cstring>

using namespace puckloop::shim;

namespace puckloop::shim {

namespace {
struct Found {
    bool any = false;
    wire::ProcessEntry* ended = nullptr;  ///< the oldest of those
};

bool matches(const wire::ProcessEntry& entry, pid_t which) {
    if (which == -1) return true;
    if (which > 0) return entry.number == which;
    return entry.group == (which == 0 ? own().group : -which);
}

Found find_children(pid_t which) {
    Found found;
    for (wire::ProcessEntry& entry : page().processes) {
        if (entry.state == wire::ProcessEntry::Free) continue;
        if (entry.parent != static_cast<std::int32_t>(own_slot()) || !matches(entry, which)) continue;
        found.any = true;
        if (entry.state != wire::ProcessEntry::Ended) continue;
        if (found.ended == nullptr || entry.number < found.ended->number) found.ended = &entry;
    }
    return found;
}
}  // namespace

pid_t await_child(pid_t which, int* status, int options, Time& used) {
    mark_call("waitpid");
    pthread_testcancel();
    charge(page().charges.device);
    bool interrupted = false;
    while (true) {
        const Found found = find_children(which);
        if (found.ended != nullptr) {
            const pid_t number = found.ended->number;
            used = found.ended->computed;
            const int ended_with = found.ended->status;
            if ((options & WNOWAIT) == 0)
                own().children_computed += found.ended->computed + found.ended->children_computed;
            if ((options & WNOWAIT) == 0) {
                wire::Request request;
                request.op = wire::Op::Reap;
                request.a = static_cast<std::uint32_t>(found.ended - page().processes);
                device_call(request);
            }
            return status == nullptr || put_to_program(status, ended_with) ? number : -1;
        }
        if (!found.any) return fail(ECHILD);
        if ((options & WNOHANG) != 0) return 0;
        if (interrupted) return fail(EINTR);
        WaitOptions wait;
        wait.interruptible = true;
        wait.cancellable = true;
        interrupted = park(external_key(), wait) == Wake::Signal && !self()->restarts;
    }
}

pid_t await_child(pid_t which, int* status, int options) {
    Time ignored = 0;
    return await_child(which, status, options, ignored);
}

}  // namespace puckloop::shim

SHIM_EXPORT pid_t waitpid(pid_t which, int* status, int options) {
    return active() ? await_child(which, status, options) : REAL(waitpid)(which, status, options);
}

SHIM_EXPORT pid_t wait(int* status) {
    return active() ? await_child(-1, status, 0) : REAL(wait)(status);
}

SHIM_EXPORT pid_t wait4(pid_t which, int* status, int options, rusage* usage) noexcept {
    if (!active()) return REAL(wait4)(which, status, options, usage);
    Time used = 0;
    const pid_t child = await_child(which, status, options, used);
    rusage result{};
    result.ru_stime = {used / kSecond, used % kSecond / kMicrosecond};
    if (child > 0 && usage != nullptr && !put_to_program(usage, result)) return -1;
    return child;
}

SHIM_EXPORT pid_t wait3(int* status, int options, rusage* usage) noexcept {
    if (!active()) return REAL(wait3)(status, options, usage);
    return wait4(-1, status, options, usage);
}

SHIM_EXPORT int waitid(idtype_t kind, id_t id, siginfo_t* theirs, int options) {
    if (!active()) return REAL(waitid)(kind, id, theirs, options);
    if (kind != P_ALL && kind != P_PID && kind != P_PGID) {
        note("waitid: process descriptors are not supported");
        return fail(EINVAL);
    }
    const auto number = static_cast<pid_t>(id);
    const pid_t which = kind == P_ALL ? -1 : kind == P_PID ? number : number == 0 ? 0 : -number;
    int status = 0;
    const pid_t child = await_child(which, &status, options);
    if (child < 0) return -1;
    if (theirs == nullptr) return 0;
    siginfo_t made{};
    siginfo_t* const info = &made;
    if (child == 0) return put_to_program(theirs, made) ? 0 : -1;
    info->si_signo = SIGCHLD;
    info->si_pid = child;
    info->si_code = WIFEXITED(status) ? CLD_EXITED : WCOREDUMP(status) ? CLD_DUMPED : CLD_KILLED;
    info->si_status = WIFEXITED(status) ? WEXITSTATUS(status) : WTERMSIG(status);
    return put_to_program(theirs, made) ? 0 : -1;
}
