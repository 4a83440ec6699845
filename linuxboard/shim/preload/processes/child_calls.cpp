// fork() and what is made of it. The children run in simulated time like the process that made them.
//
// Deviations: 1. vfork() copies, as fork() does. 2. Timers with a descriptor stay with the parent. 3. Flags
// of a device's descriptor (O_NONBLOCK, the I2C address) are each process's own after fork().

#include "linuxboard/shim/preload/host/direct_syscalls.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/inheritance.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/scheduler/timers.h"

#include <fcntl.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

extern "C" pid_t _Fork(void) noexcept;

using namespace puckloop::shim;

namespace {
constexpr int kBorn = -2;  ///< of in_between(): this is the new process
constexpr int kNoProcess = 255;

int bear(void*) {
    const pid_t born = REAL(_Fork)();
    if (born == 0) return kBorn;
    return born < 0 ? kNoProcess : 0;
}

void begin_child(const Birth& birth) {
    change_link(birth.link, birth.slot);
    drop_all_timers();
    only_this_thread();
    conduct_direct_syscalls();
    say_hello(true);
}

int run_shell(const char* command) {
    execl("/bin/sh", "sh", "-c", command, nullptr);
    _exit(127);
}

struct Opened {
    FILE* file = nullptr;
    pid_t process = 0;
};
constexpr int kMostOpened = 64;
Opened opened[kMostOpened];
}  // namespace

namespace {
pid_t make_copy(bool with_handlers) {
    mark_call("fork");
    Birth birth;
    if (!ask_for_process(birth, {})) return -1;
    const int status = in_between(bear, nullptr, with_handlers);
    if (status == kBorn) {
        begin_child(birth);
        return 0;
    }
    const pid_t child = report_birth(birth, status == 0);
    if (child < 0) errno = EAGAIN;
    return child;
}
}  // namespace

namespace puckloop::shim {
pid_t fork_plainly() {
    return make_copy(false);
}
}  // namespace puckloop::shim

SHIM_EXPORT pid_t fork() noexcept {
    return active() ? make_copy(true) : REAL(fork)();
}

SHIM_EXPORT pid_t vfork() noexcept {
    return fork();
}

SHIM_EXPORT int daemon(int stay, int keep_output) noexcept {
    if (!active()) return REAL(daemon)(stay, keep_output);
    const pid_t child = fork();
    if (child < 0) return -1;
    if (child > 0) _exit(0);
    setsid();
    if (stay == 0 && chdir("/") != 0) return -1;
    if (keep_output == 0) {
        const int nothing = open("/dev/null", O_RDWR);
        for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
            dup2(nothing, fd);
        if (nothing > STDERR_FILENO) close(nothing);
    }
    return 0;
}

SHIM_EXPORT int system(const char* command) {
    if (!active()) return REAL(system)(command);
    mark_call("system");
    if (command == nullptr) return 1;
    struct sigaction ignore {
    }, interrupt{}, quit{};
    ignore.sa_handler = SIG_IGN;
    sigaction(SIGINT, &ignore, &interrupt);
    sigaction(SIGQUIT, &ignore, &quit);
    sigset_t children, before;
    sigemptyset(&children);
    sigaddset(&children, SIGCHLD);
    pthread_sigmask(SIG_BLOCK, &children, &before);
    const auto restore = [&] {
        sigaction(SIGINT, &interrupt, nullptr);
        sigaction(SIGQUIT, &quit, nullptr);
        pthread_sigmask(SIG_SETMASK, &before, nullptr);
    };
    const pid_t child = fork();
    if (child == 0) {
        restore();
        run_shell(command);
    }
    int status = -1;
    while (child > 0 && waitpid(child, &status, 0) < 0 && errno == EINTR) {
    }
    restore();
    return status;
}

SHIM_EXPORT FILE* popen(const char* command, const char* mode) {
    if (!active()) return REAL(popen)(command, mode);
    mark_call("popen");
    const bool reads = std::strchr(mode, 'r') != nullptr;
    Opened* entry = nullptr;
    for (Opened& candidate : opened)
        if (candidate.file == nullptr) entry = &candidate;
    int ends[2];
    if (entry == nullptr || pipe2(ends, O_CLOEXEC) != 0) return nullptr;
    const int mine = ends[reads ? 0 : 1], other = ends[reads ? 1 : 0];
    const pid_t child = fork();
    if (child == 0) {
        const int standard = reads ? STDOUT_FILENO : STDIN_FILENO;
        if (other == standard) {
            fcntl(other, F_SETFD, 0);
        } else {
            dup2(other, standard);
        }
        for (const Opened& earlier : opened)
            if (earlier.file != nullptr) close(fileno(earlier.file));
        run_shell(command);
    }
    close(other);
    if (child < 0) {
        close(mine);
        return nullptr;
    }
    if (std::strchr(mode, 'e') == nullptr) fcntl(mine, F_SETFD, 0);
    *entry = {fdopen(mine, reads ? "r" : "w"), child};
    return entry->file;
}

SHIM_EXPORT int pclose(FILE* file) {
    for (Opened& entry : opened) {
        if (file == nullptr || entry.file != file) continue;
        const pid_t child = entry.process;
        entry = {};
        fclose(file);
        int status = -1;
        while (waitpid(child, &status, 0) < 0)
            if (errno != EINTR) return -1;
        return status;
    }
    return REAL(pclose)(file);
}
