// open, close, read, write and their kin.

#include "linuxboard/shim/preload/link.h"
#include "linuxboard/shim/preload/open_file.h"
#include "linuxboard/shim/preload/real.h"
#include "linuxboard/shim/preload/timers.h"

#include <fcntl.h>
#include <sys/eventfd.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstring>

using namespace puckloop::shim;

extern "C" {
int __open_2(const char*, int);
int __open64_2(const char*, int);
int __openat_2(int, const char*, int);
int __openat64_2(int, const char*, int);
ssize_t __read_chk(int, void*, size_t, size_t);
}

namespace {
mode_t mode_argument(int flags, std::va_list arguments) {
    return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

/// A file that never blocks, or that nobody conducts.
bool goes_straight(int fd) {
    if (!active() || thread_count() == 0) return true;
    struct stat status {};
    if (REAL(fstat)(fd, &status) != 0) return true;
    if (S_ISREG(status.st_mode) || S_ISDIR(status.st_mode)) return true;
    return (REAL(fcntl)(fd, F_GETFL) & O_NONBLOCK) != 0;
}

template <typename Call>
ssize_t outside(int fd, short events, Call call) {
    if (!active()) return call();
    if (goes_straight(fd)) {
        charge(page().charges.device);
    } else if (!await_external(fd, events)) {
        errno = EINTR;
        return -1;
    }
    const ssize_t result = call();
    const int error = errno;
    external_changed();
    errno = error;
    return result;
}
constexpr short kReadable = 0x001;  // POLLIN
constexpr short kWritable = 0x004;  // POLLOUT
}  // namespace

SHIM_EXPORT int open(const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_of(path);
    return device == kNoDevice ? REAL(open)(path, flags, mode) : open_device(device, flags);
}

SHIM_EXPORT int open64(const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_of(path);
    return device == kNoDevice ? REAL(open64)(path, flags, mode) : open_device(device, flags);
}

SHIM_EXPORT int openat(int folder, const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_of(path);
    return device == kNoDevice ? REAL(openat)(folder, path, flags, mode) : open_device(device, flags);
}

SHIM_EXPORT int openat64(int folder, const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_of(path);
    return device == kNoDevice ? REAL(openat64)(folder, path, flags, mode) : open_device(device, flags);
}

SHIM_EXPORT int __open_2(const char* path, int flags) {
    return open(path, flags);
}
SHIM_EXPORT int __open64_2(const char* path, int flags) {
    return open64(path, flags);
}
SHIM_EXPORT int __openat_2(int folder, const char* path, int flags) {
    return openat(folder, path, flags);
}
SHIM_EXPORT int __openat64_2(int folder, const char* path, int flags) {
    return openat64(folder, path, flags);
}

SHIM_EXPORT int creat(const char* path, mode_t mode) {
    return open(path, O_CREAT | O_WRONLY | O_TRUNC, mode);
}
SHIM_EXPORT int creat64(const char* path, mode_t mode) {
    return open64(path, O_CREAT | O_WRONLY | O_TRUNC, mode);
}

SHIM_EXPORT int close(int fd) {
    if (active() && is_link_descriptor(fd)) {
        errno = EBADF;
        return -1;
    }
    if (open_file(fd) != nullptr) release_file(fd);
    if (active()) drop_timer(fd);
    return REAL(close)(fd);
}

SHIM_EXPORT void closefrom(int first) noexcept {
    if (!active()) return REAL(closefrom)(first);
    const auto last = static_cast<int>(sysconf(_SC_OPEN_MAX));
    for (int fd = first; fd < std::min(last, 4096); ++fd)
        close(fd);
}

SHIM_EXPORT int close_range(unsigned first, unsigned last, int flags) noexcept {
    if (!active() || flags != 0) return REAL(close_range)(first, last, flags);
    for (unsigned fd = first; fd <= std::min(last, 4095u); ++fd)
        close(static_cast<int>(fd));
    return 0;
}

SHIM_EXPORT int dup(int fd) noexcept {
    const int copy = REAL(dup)(fd);
    if (copy >= 0 && open_file(fd) != nullptr) share_file(fd, copy);
    return copy;
}

SHIM_EXPORT int dup3(int fd, int copy, int flags) noexcept {
    if (active() && is_link_descriptor(copy)) {
        errno = EBUSY;
        return -1;
    }
    const int result = REAL(dup3)(fd, copy, flags);
    if (result >= 0 && active()) share_file(fd, copy);
    return result;
}

SHIM_EXPORT int dup2(int fd, int copy) noexcept {
    if (active() && is_link_descriptor(copy)) {
        errno = EBUSY;
        return -1;
    }
    const int result = REAL(dup2)(fd, copy);
    if (result >= 0 && active()) share_file(fd, copy);
    return result;
}

namespace {
int control(int fd, int command, long argument, decltype(&::fcntl) real) {
    OpenFile* file = open_file(fd);
    if (file != nullptr && command == F_GETFL) return file->flags | O_LARGEFILE;
    if (file != nullptr && command == F_SETFL) {
        charge(page().charges.device);
        if ((argument & O_ASYNC) != 0) note("%s: O_ASYNC (SIGIO) is not supported", file->path);
        file->flags = (file->flags & O_ACCMODE) | static_cast<int>(argument & O_NONBLOCK);
        return 0;
    }
    const int result = real(fd, command, argument);
    if (file != nullptr && result >= 0 && (command == F_DUPFD || command == F_DUPFD_CLOEXEC))
        share_file(fd, result);
    return result;
}
}  // namespace

SHIM_EXPORT int fcntl(int fd, int command, ...) {
    std::va_list arguments;
    va_start(arguments, command);
    const long argument = va_arg(arguments, long);
    va_end(arguments);
    return control(fd, command, argument, REAL(fcntl));
}

SHIM_EXPORT int fcntl64(int fd, int command, ...) {
    std::va_list arguments;
    va_start(arguments, command);
    const long argument = va_arg(arguments, long);
    va_end(arguments);
    return control(fd, command, argument, REAL(fcntl64));
}

SHIM_EXPORT int flock(int fd, int operation) noexcept {
    return open_file(fd) != nullptr ? 0 : REAL(flock)(fd, operation);
}

SHIM_EXPORT ssize_t read(int fd, void* buffer, size_t size) {
    if (OpenFile* file = open_file(fd)) return read_device(*file, buffer, size);
    return outside(fd, kReadable, [&] { return REAL(read)(fd, buffer, size); });
}

SHIM_EXPORT ssize_t __read_chk(int fd, void* buffer, size_t size, size_t room) {
    if (size > room) __builtin_trap();
    return read(fd, buffer, size);
}

SHIM_EXPORT ssize_t write(int fd, const void* data, size_t size) {
    if (OpenFile* file = open_file(fd)) return write_device(*file, data, size);
    return outside(fd, kWritable, [&] { return REAL(write)(fd, data, size); });
}

SHIM_EXPORT ssize_t readv(int fd, const iovec* parts, int count) {
    OpenFile* file = open_file(fd);
    if (file == nullptr) return outside(fd, kReadable, [&] { return REAL(readv)(fd, parts, count); });
    char data[wire::kMaximumData];
    std::size_t size = 0;
    for (int i = 0; i < count; ++i)
        size += parts[i].iov_len;
    const std::int64_t result = read_device(*file, data, std::min(size, sizeof data));
    const char* cursor = data;
    std::int64_t left = result;
    for (int i = 0; i < count && left > 0; ++i) {
        const auto part = std::min<std::size_t>(parts[i].iov_len, static_cast<std::size_t>(left));
        std::memcpy(parts[i].iov_base, cursor, part);
        cursor += part;
        left -= static_cast<std::int64_t>(part);
    }
    return result;
}

SHIM_EXPORT ssize_t writev(int fd, const iovec* parts, int count) {
    OpenFile* file = open_file(fd);
    if (file == nullptr) return outside(fd, kWritable, [&] { return REAL(writev)(fd, parts, count); });
    char data[wire::kMaximumData];
    std::size_t size = 0;
    for (int i = 0; i < count; ++i) {
        const std::size_t part = std::min(parts[i].iov_len, sizeof data - size);
        std::memcpy(data + size, parts[i].iov_base, part);
        size += part;
    }
    return write_device(*file, data, size);
}

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
    return outside(fd, kReadable, [&] { return REAL(recv)(fd, buffer, size, flags); });
}

SHIM_EXPORT ssize_t recvfrom(int fd, void* buffer, size_t size, int flags, sockaddr* from,
                             socklen_t* length) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recvfrom)(fd, buffer, size, flags, from, length);
    return outside(fd, kReadable, [&] { return REAL(recvfrom)(fd, buffer, size, flags, from, length); });
}

SHIM_EXPORT ssize_t recvmsg(int fd, msghdr* message, int flags) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(recvmsg)(fd, message, flags);
    return outside(fd, kReadable, [&] { return REAL(recvmsg)(fd, message, flags); });
}

SHIM_EXPORT ssize_t send(int fd, const void* data, size_t size, int flags) {
    if ((flags & MSG_DONTWAIT) != 0) return REAL(send)(fd, data, size, flags);
    return outside(fd, kWritable, [&] { return REAL(send)(fd, data, size, flags); });
}

SHIM_EXPORT int accept4(int fd, sockaddr* from, socklen_t* length, int flags) {
    return static_cast<int>(outside(fd, kReadable, [&] { return REAL(accept4)(fd, from, length, flags); }));
}

SHIM_EXPORT int accept(int fd, sockaddr* from, socklen_t* length) {
    return accept4(fd, from, length, 0);
}

// A program that looks for its device before it opens it finds the one it will get.
namespace {
const char* stand_in(const char* path) {
    return device_of(path) == kNoDevice ? path : "/dev/null";
}
}  // namespace

SHIM_EXPORT int access(const char* path, int mode) noexcept {
    return REAL(access)(stand_in(path), mode);
}
SHIM_EXPORT int faccessat(int folder, const char* path, int mode, int flags) noexcept {
    return REAL(faccessat)(folder, stand_in(path), mode, flags);
}
SHIM_EXPORT int stat(const char* path, struct stat* status) noexcept {
    return REAL(stat)(stand_in(path), status);
}
SHIM_EXPORT int stat64(const char* path, struct stat64* status) noexcept {
    return REAL(stat64)(stand_in(path), status);
}
SHIM_EXPORT int lstat(const char* path, struct stat* status) noexcept {
    return REAL(lstat)(stand_in(path), status);
}
SHIM_EXPORT int lstat64(const char* path, struct stat64* status) noexcept {
    return REAL(lstat64)(stand_in(path), status);
}
SHIM_EXPORT int fstatat(int folder, const char* path, struct stat* status, int flags) noexcept {
    return REAL(fstatat)(folder, stand_in(path), status, flags);
}
SHIM_EXPORT int fstatat64(int folder, const char* path, struct stat64* status, int flags) noexcept {
    return REAL(fstatat64)(folder, stand_in(path), status, flags);
}
