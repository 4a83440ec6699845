// The process as a whole: begin, end, random numbers.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/direct_syscalls.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/processes/begin_process.h"
#include "linuxboard/shim/preload/processes/inheritance.h"
#include "linuxboard/shim/preload/processes/make_process.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <sys/random.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

using namespace puckloop::shim;

namespace puckloop::shim {

void prepare_threads(Thread* main_thread);

namespace {
void leave_by_exit(int status, void*) {
    if (active()) std::fflush(nullptr);  // a pipe may be full: that is waited for in simulated time
    announce_exit(status);
}

void left_by_unknown_fork() {
    if (!is_making_process())
        refuse("a child process that was not made by fork(), posix_spawn(), system() or popen(): ended");
    go_passive();
}
}  // namespace

void begin_process(Thread* main_thread) {
    prepare_threads(main_thread);
    // Registered first, so it runs after everything the program registers.
    on_exit(leave_by_exit, nullptr);
    pthread_atfork(nullptr, nullptr, left_by_unknown_fork);
    // What a program has said is in the log even if it is killed.
    if (std::getenv("_STDBUF_O") == nullptr) std::setvbuf(stdout, nullptr, _IOLBF, BUFSIZ);
    prepare_direct_syscalls();
    conduct_direct_syscalls();
    take_over(say_hello(false));
}

}  // namespace puckloop::shim

SHIM_EXPORT void _exit(int status) {
    announce_exit(status);
    REAL(_exit)(status);
    __builtin_unreachable();
}

SHIM_EXPORT void _Exit(int status) noexcept {
    _exit(status);
}

SHIM_EXPORT ssize_t getrandom(void* buffer, size_t size, unsigned flags) {
    if (!active()) return REAL(getrandom)(buffer, size, flags);
    return read_random(buffer, size);
}

SHIM_EXPORT int getentropy(void* buffer, size_t size) {
    if (!active()) return REAL(getentropy)(buffer, size);
    constexpr size_t kMost = 256;
    if (size > kMost) return fail(EIO);
    return read_random(buffer, size) < 0 ? -1 : 0;
}

// std::random_device asks the processor where it can; this is its way to a number in libstdc++.
SHIM_EXPORT unsigned _ZNSt13random_device9_M_getvalEv(void*) {
    unsigned value = 0;
    if (active()) {
        random_bytes(&value, sizeof value);
    } else {
        REAL(getrandom)(&value, sizeof value, 0);
    }
    return value;
}
