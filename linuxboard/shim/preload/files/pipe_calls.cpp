// Pipes, socket pairs and event descriptors: what threads of the program hand each other is conducted, what
// comes from outside is looked at.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/waiting/outside.h"

#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

using namespace puckloop::shim;

SHIM_EXPORT int pipe2(int* fds, int flags) noexcept {
    const int result = REAL(pipe2)(fds, flags);
    if (result == 0 && active()) {
        mark_internal(fds[0]);
        mark_internal(fds[1]);
    }
    return result;
}

SHIM_EXPORT int pipe(int* fds) noexcept {
    return pipe2(fds, 0);
}

SHIM_EXPORT int socketpair(int domain, int type, int protocol, int* fds) noexcept {
    const int result = REAL(socketpair)(domain, type, protocol, fds);
    if (result == 0 && active()) {
        mark_internal(fds[0]);
        mark_internal(fds[1]);
    }
    return result;
}

SHIM_EXPORT int eventfd(unsigned value, int flags) noexcept {
    const int fd = REAL(eventfd)(value, flags);
    if (active()) mark_internal(fd);
    return fd;
}
