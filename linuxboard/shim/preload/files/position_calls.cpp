// Calls that need a place in a file: a serial port has none, an I2C adapter and a camera ignore it. And calls
// that move data without a buffer of the program, which devices do not know.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/waiting/outside.h"

#include <fcntl.h>
#include <sys/sendfile.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>

using namespace puckloop::shim;

extern "C" {
ssize_t __pread_chk(int, void*, size_t, off_t, size_t);
ssize_t __pread64_chk(int, void*, size_t, off64_t, size_t);
ssize_t preadv64v2(int, const iovec*, int, off64_t, int);
ssize_t pwritev64v2(int, const iovec*, int, off64_t, int);
}

namespace {

bool is_link(int fd) {
    return active() && is_link_descriptor(fd);
}

/// 0 if a read or write at `offset` is one at any place; -1 and errno.
int check_position(const OpenFile& file, off_t offset) {
    if (offset < 0) return fail(EINVAL);
    const bool has_none = file.kind == OpenFile::Kind::Tty || file.kind == OpenFile::Kind::Socket;
    return has_none ? fail(ESPIPE) : 0;
}

/// Also the link's, which are none of the program's.
bool is_the_nodes(int fd) {
    return open_file(fd) != nullptr || is_link(fd);
}

/// Of preadv2() and pwritev2(): terminals take what changes nothing for them, the others a wish for polling.
bool takes_flags(const OpenFile& file, int flags) {
    const int taken =
        file.kind == OpenFile::Kind::Tty ? RWF_HIPRI | RWF_DSYNC | RWF_SYNC | RWF_APPEND : RWF_HIPRI;
    return (flags & ~taken) == 0;
}

off_t seek(const OpenFile& file, int from) {
    if (file.kind == OpenFile::Kind::Random) return 0;
    return from < SEEK_SET || from > SEEK_HOLE ? fail(EINVAL) : fail(ESPIPE);
}
}  // namespace

SHIM_EXPORT off_t lseek(int fd, off_t offset, int from) noexcept {
    if (is_link(fd)) return fail(EBADF);
    const OpenFile* file = open_file(fd);
    return file == nullptr ? REAL(lseek)(fd, offset, from) : seek(*file, from);
}
SHIM_EXPORT off64_t lseek64(int fd, off64_t offset, int from) noexcept {
    if (is_link(fd)) return fail(EBADF);
    const OpenFile* file = open_file(fd);
    return file == nullptr ? REAL(lseek64)(fd, offset, from) : seek(*file, from);
}

SHIM_EXPORT ssize_t pread(int fd, void* buffer, size_t size, off_t offset) {
    if (is_link(fd)) return fail(EBADF);
    OpenFile* file = open_file(fd);
    if (file == nullptr) return REAL(pread)(fd, buffer, size, offset);
    return check_position(*file, offset) != 0 ? -1 : read_device(*file, buffer, size);
}
SHIM_EXPORT ssize_t pread64(int fd, void* buffer, size_t size, off64_t offset) {
    return pread(fd, buffer, size, offset);
}
SHIM_EXPORT ssize_t __pread_chk(int fd, void* buffer, size_t size, off_t offset, size_t room) {
    if (size > room) __builtin_trap();
    return pread(fd, buffer, size, offset);
}
SHIM_EXPORT ssize_t __pread64_chk(int fd, void* buffer, size_t size, off64_t offset, size_t room) {
    return __pread_chk(fd, buffer, size, offset, room);
}
SHIM_EXPORT ssize_t pwrite(int fd, const void* data, size_t size, off_t offset) {
    if (is_link(fd)) return fail(EBADF);
    OpenFile* file = open_file(fd);
    if (file == nullptr) return REAL(pwrite)(fd, data, size, offset);
    return check_position(*file, offset) != 0 ? -1 : write_device(*file, data, size);
}
SHIM_EXPORT ssize_t pwrite64(int fd, const void* data, size_t size, off64_t offset) {
    return pwrite(fd, data, size, offset);
}

SHIM_EXPORT ssize_t preadv(int fd, const iovec* parts, int count, off_t offset) {
    if (is_link(fd)) return fail(EBADF);
    const OpenFile* file = open_file(fd);
    if (file == nullptr) return REAL(preadv)(fd, parts, count, offset);
    return check_position(*file, offset) != 0 ? -1 : readv(fd, parts, count);
}
SHIM_EXPORT ssize_t preadv64(int fd, const iovec* parts, int count, off64_t offset) {
    return preadv(fd, parts, count, offset);
}
SHIM_EXPORT ssize_t pwritev(int fd, const iovec* parts, int count, off_t offset) {
    if (is_link(fd)) return fail(EBADF);
    const OpenFile* file = open_file(fd);
    if (file == nullptr) return REAL(pwritev)(fd, parts, count, offset);
    return check_position(*file, offset) != 0 ? -1 : writev(fd, parts, count);
}
SHIM_EXPORT ssize_t pwritev64(int fd, const iovec* parts, int count, off64_t offset) {
    return pwritev(fd, parts, count, offset);
}
/// With offset -1 it is readv() with flags.
SHIM_EXPORT ssize_t preadv2(int fd, const iovec* parts, int count, off_t offset, int flags) {
    if (is_link(fd)) return fail(EBADF);
    if (!is_the_nodes(fd)) return REAL(preadv2)(fd, parts, count, offset, flags);
    if (!takes_flags(*open_file(fd), flags)) return fail(EOPNOTSUPP);
    return offset == -1 ? readv(fd, parts, count) : preadv(fd, parts, count, offset);
}
SHIM_EXPORT ssize_t pwritev2(int fd, const iovec* parts, int count, off_t offset, int flags) {
    if (is_link(fd)) return fail(EBADF);
    if (!is_the_nodes(fd)) return REAL(pwritev2)(fd, parts, count, offset, flags);
    if (!takes_flags(*open_file(fd), flags)) return fail(EOPNOTSUPP);
    return offset == -1 ? writev(fd, parts, count) : pwritev(fd, parts, count, offset);
}

SHIM_EXPORT ssize_t preadv64v2(int fd, const iovec* parts, int count, off64_t offset, int flags) {
    return preadv2(fd, parts, count, offset, flags);
}
SHIM_EXPORT ssize_t pwritev64v2(int fd, const iovec* parts, int count, off64_t offset, int flags) {
    return pwritev2(fd, parts, count, offset, flags);
}

SHIM_EXPORT ssize_t sendfile(int to, int from, off_t* offset, size_t size) noexcept {
    if (socket_file(to) != nullptr && !is_the_nodes(from))
        return static_cast<ssize_t>(send_file(to, from, offset, size));
    return is_the_nodes(to) || is_the_nodes(from) ? fail(EINVAL) : REAL(sendfile)(to, from, offset, size);
}
SHIM_EXPORT ssize_t sendfile64(int to, int from, off64_t* offset, size_t size) noexcept {
    return sendfile(to, from, offset, size);
}
SHIM_EXPORT ssize_t splice(int from, off64_t* from_offset, int to, off64_t* to_offset, size_t size,
                           unsigned flags) {
    if (is_the_nodes(to) || is_the_nodes(from)) return fail(EINVAL);
    const auto call = [&] { return REAL(splice)(from, from_offset, to, to_offset, size, flags); };
    if ((flags & SPLICE_F_NONBLOCK) != 0) return call();
    return is_channel(from) ? outside(from, POLLIN, call) : outside(to, POLLOUT, call);
}
SHIM_EXPORT ssize_t tee(int from, int to, size_t size, unsigned flags) {
    const auto call = [&] { return REAL(tee)(from, to, size, flags); };
    return (flags & SPLICE_F_NONBLOCK) != 0 ? call() : outside(from, POLLIN, call);
}
SHIM_EXPORT ssize_t vmsplice(int fd, const iovec* parts, size_t count, unsigned flags) {
    const auto call = [&] { return REAL(vmsplice)(fd, parts, count, flags); };
    return (flags & SPLICE_F_NONBLOCK) != 0 ? call() : outside(fd, POLLOUT, call);
}
SHIM_EXPORT ssize_t copy_file_range(int from, off64_t* from_offset, int to, off64_t* to_offset, size_t size,
                                    unsigned flags) {
    if (is_the_nodes(to) || is_the_nodes(from)) return fail(EINVAL);
    return REAL(copy_file_range)(from, from_offset, to, to_offset, size, flags);
}
