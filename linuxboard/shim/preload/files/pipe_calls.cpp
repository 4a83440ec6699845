// Pipes, socket pairs, event descriptors and sockets: what threads of the program hand each other is
// conducted, what comes from outside is looked at.

#include "linuxboard/shim/preload/outside.h"

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

SHIM_EXPORT ssize_t recv(int fd, void* buffer, size_t size, int flags) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recv)(fd, buffer, size, flags);
    return outside(fd, POLLIN, [&] { return REAL(recv)(fd, buffer, size, flags); });
}

SHIM_EXPORT ssize_t recvfrom(int fd, void* buffer, size_t size, int flags, sockaddr* from,
                             socklen_t* length) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recvfrom)(fd, buffer, size, flags, from, length);
    return outside(fd, POLLIN, [&] { return REAL(recvfrom)(fd, buffer, size, flags, from, length); });
}

SHIM_EXPORT ssize_t recvmsg(int fd, msghdr* message, int flags) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recvmsg)(fd, message, flags);
    return outside(fd, POLLIN, [&] { return REAL(recvmsg)(fd, message, flags); });
}

SHIM_EXPORT ssize_t send(int fd, const void* data, size_t size, int flags) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(send)(fd, data, size, flags);
    return outside(fd, POLLOUT, [&] { return REAL(send)(fd, data, size, flags); });
}

SHIM_EXPORT int accept4(int fd, sockaddr* from, socklen_t* length, int flags) {
    return static_cast<int>(outside(fd, POLLIN, [&] { return REAL(accept4)(fd, from, length, flags); }));
}

SHIM_EXPORT int accept(int fd, sockaddr* from, socklen_t* length) {
    return accept4(fd, from, length, 0);
}
