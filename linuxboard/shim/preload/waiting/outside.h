#pragma once
// A call on a descriptor that is no device: made at once where it cannot block, else once the host is ready.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <sys/types.h>

#include <cerrno>

namespace puckloop::shim {

inline bool is_file(int fd) {
    struct stat status {};
    return REAL(fstat)(fd, &status) == 0 && (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode));
}

/// A file that never blocks, or that nobody conducts.
inline bool goes_straight(int fd) {
    if (!active() || thread_count() == 0) return true;
    struct stat status {};
    if (REAL(fstat)(fd, &status) != 0) return true;
    if (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) return true;
    return (REAL(fcntl)(fd, F_GETFL) & O_NONBLOCK) != 0;
}

template <typename Call>
ssize_t outside(int fd, short events, Call call) {
    if (!active()) return call();
    if (is_link_descriptor(fd)) {  // none of the program's
        return fail(EBADF);
    }
    if (goes_straight(fd)) {
        charge(page().charges.device);
    } else if (!await_external(fd, events))
        return fail(EINTR);
    const ssize_t result = call();
    const int error = errno;
    external_changed();
    if (!is_file(fd)) tell_others();
    errno = error;
    return result;
}

}  // namespace puckloop::shim
