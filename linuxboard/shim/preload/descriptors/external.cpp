// Descriptors that are no devices: files go straight to the host; pipes, sockets and the like may block, and
// while one thread blocked in the host no other could run. So they are looked at, not waited in.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <poll.h>
#include <sys/stat.h>

#include <algorithm>
#include <bitset>
#include <cerrno>

namespace puckloop::shim {

namespace {
std::bitset<kMostDescriptors> internal;
}  // namespace

void mark_internal(int fd) {
    if (fd >= 0 && fd < kMostDescriptors) internal.set(static_cast<std::size_t>(fd));
}

void forget_internal(int fd) {
    if (fd >= 0 && fd < kMostDescriptors) internal.reset(static_cast<std::size_t>(fd));
}

bool is_internal(int fd) {
    return fd >= 0 && fd < kMostDescriptors && internal.test(static_cast<std::size_t>(fd));
}

bool is_named_pipe(const char* path) {
    struct stat status {};
    return active() && path != nullptr && REAL(stat)(path, &status) == 0 && S_ISFIFO(status.st_mode);
}

bool look_again(Time deadline) {
    WaitOptions options;
    options.deadline = std::min(deadline, time_after(kExternalPeriod));
    options.interruptible = true;
    options.cancellable = true;
    return park(external_key(), options) != Wake::Signal || self()->restarts;
}

bool await_external(int fd, short events) {
    pollfd entry{fd, events, 0};
    while (REAL(poll)(&entry, 1, 0) == 0) {
        if (!is_internal(fd)) {
            note("the program waits on descriptor %d, which is outside of simulated time: runs may differ",
                 fd);
        }
        if (!look_again(kNever)) return false;
    }
    return true;
}

}  // namespace puckloop::shim
