// posix_spawn(). Without file actions the C library makes the new process; with some, which may open or copy
// devices, the process is a copy that does them by the calls taken over and then executes the program.

#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/file_actions.h"
#include "linuxboard/shim/preload/processes/inheritance.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <fcntl.h>
#include <limits.h>
#include <sched.h>
#include <spawn.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

using namespace puckloop::shim;

namespace {
struct Spawn {
    const char* file;
    const posix_spawnattr_t* attributes;
    char* const* arguments;
    char* const* environment;
    int link;
};

int spawn_there(void* context) {
    const Spawn& spawn = *static_cast<const Spawn*>(context);
    place_link(spawn.link);
    go_passive();  // the C library's own dup2() for the new process is the host's
    pid_t ignored = 0;
    return REAL(posix_spawn)(&ignored, spawn.file, nullptr, spawn.attributes, spawn.arguments,
                             spawn.environment);
}

struct SpawnCopy {
    const char* file;
    const std::vector<FileAction>& actions;
    const posix_spawnattr_t* attributes;
    char* const* arguments;
    char* const* environment;
};

bool has_flag(const posix_spawnattr_t* attributes, int flag) {
    short flags = 0;
    if (attributes != nullptr) posix_spawnattr_getflags(attributes, &flags);
    return (flags & flag) != 0;
}

/// In the copy, in the order of glibc; 0, or the error.
int take_attributes(const posix_spawnattr_t* attributes) {
    if (attributes == nullptr) return 0;
    const auto has = [attributes](int flag) { return has_flag(attributes, flag); };
    sigset_t defaults;
    sigemptyset(&defaults);
    if (has(POSIX_SPAWN_SETSIGDEF)) posix_spawnattr_getsigdefault(attributes, &defaults);
    for (int number = 1; number < NSIG; ++number)
        if (sigismember(&defaults, number) == 1) signal(number, SIG_DFL);
    sched_param parameters{};
    posix_spawnattr_getschedparam(attributes, &parameters);
    if (has(POSIX_SPAWN_SETSCHEDULER)) {
        int policy = 0;
        posix_spawnattr_getschedpolicy(attributes, &policy);
        if (sched_setscheduler(0, policy, &parameters) < 0) return errno;
    } else if (has(POSIX_SPAWN_SETSCHEDPARAM) && sched_setparam(0, &parameters) < 0) {
        return errno;
    }
    if (has(POSIX_SPAWN_SETSID) && setsid() < 0) return errno;
    pid_t group = 0;
    posix_spawnattr_getpgroup(attributes, &group);
    if (has(POSIX_SPAWN_SETPGROUP) && setpgid(0, group) < 0) return errno;
    if (has(POSIX_SPAWN_RESETIDS) && (seteuid(getuid()) < 0 || setegid(getgid()) < 0)) return errno;
    return 0;
}

/// Does not return: the program is executed, or its error goes into `answer`.
[[noreturn]] void become(const SpawnCopy& spawn, int answer) {
    int error = take_attributes(spawn.attributes);
    if (error == 0) error = take_actions(spawn.actions, answer);
    if (has_flag(spawn.attributes, POSIX_SPAWN_SETSIGMASK)) {
        sigset_t mask;
        posix_spawnattr_getsigmask(spawn.attributes, &mask);
        pthread_sigmask(SIG_SETMASK, &mask, nullptr);
    }
    if (error == 0) {
        execve(spawn.file, spawn.arguments, spawn.environment != nullptr ? spawn.environment : environ);
        error = errno;
    }
    if (write(answer, &error, sizeof error) != sizeof error) error = ECHILD;
    _exit(127);
}

/// The pipe is closed without a word when the program has begun.
int spawn_copy(pid_t* pid, const SpawnCopy& spawn) {
    constexpr int kOutOfTheWay = 512;  // a program's own descriptors are below
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) return errno;
    const pid_t child = fork_plainly();
    if (child == 0) {
        const int high = fcntl(ends[1], F_DUPFD_CLOEXEC, kOutOfTheWay);
        if (high >= 0) close(ends[1]);
        close(ends[0]);
        become(spawn, high >= 0 ? high : ends[1]);
    }
    int error = child < 0 ? errno : 0;
    close(ends[1]);
    if (child > 0 && read(ends[0], &error, sizeof error) == sizeof error) {
        while (waitpid(child, nullptr, 0) < 0 && errno == EINTR) {
        }
    }
    close(ends[0]);
    if (error == 0 && pid != nullptr) *pid = child;
    return error;
}
}  // namespace

SHIM_EXPORT int posix_spawn(pid_t* pid, const char* path, const posix_spawn_file_actions_t* actions,
                            const posix_spawnattr_t* attributes, char* const* arguments,
                            char* const* environment) {
    if (!active()) return REAL(posix_spawn)(pid, path, actions, attributes, arguments, environment);
    mark_call("posix_spawn");
    if (!can_be_conducted(path, true)) return EACCES;
    const std::vector<FileAction>* list = actions_of(actions);
    if (list != nullptr && !list->empty())
        return spawn_copy(pid, {path, *list, attributes, arguments, environment});
    Birth birth;
    if (!ask_for_process(birth, leave(false))) return errno;
    char** linked = linked_environment(environment, birth.slot);
    Spawn spawn{path, attributes, arguments, linked, birth.link};
    const int error = in_between(spawn_there, &spawn, false);
    free(linked);
    const pid_t child = report_birth(birth, error == 0);
    if (error != 0) return error < 0 ? EAGAIN : error;
    if (pid != nullptr) *pid = child;
    return 0;
}

SHIM_EXPORT int posix_spawnp(pid_t* pid, const char* file, const posix_spawn_file_actions_t* actions,
                             const posix_spawnattr_t* attributes, char* const* arguments,
                             char* const* environment) {
    if (!active()) return REAL(posix_spawnp)(pid, file, actions, attributes, arguments, environment);
    char room[PATH_MAX];
    return posix_spawn(pid, search_path(file, room), actions, attributes, arguments, environment);
}
