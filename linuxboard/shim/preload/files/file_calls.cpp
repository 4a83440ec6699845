// open, close, read, write and their kin.

#include "linuxboard/shim/preload/descriptors/external.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/descriptors/process_paths.h"
#include "linuxboard/shim/preload/descriptors/video_names.h"
#include "linuxboard/shim/preload/files/shared_calls.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/machine/machine_files.h"
#include "linuxboard/shim/preload/network/sockets.h"
#include "linuxboard/shim/preload/scheduler/board_clock.h"
#include "linuxboard/shim/preload/scheduler/outside_news.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"
#include "linuxboard/shim/preload/scheduler/signal_origins.h"
#include "linuxboard/shim/preload/scheduler/timers.h"
#include "linuxboard/shim/preload/waiting/outside.h"

#include <fcntl.h>
#include <signal.h>
#include <sys/file.h>
#include <sys/signalfd.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstring>
#include <vector>

using namespace puckloop::shim;

extern "C" {
int __open_2(const char*, int);
int __open64_2(const char*, int);
int __openat_2(int, const char*, int);
int __openat64_2(int, const char*, int);
ssize_t __read_chk(int, void*, size_t, size_t);
}

namespace {
/// `copy` is now what `fd` is.
void copied(int fd, int copy) {
    if (fd == copy) return;
    share_file(fd, copy);
    const bool closed = is_internal(copy);
    drop_timer(copy);
    if (is_internal(fd)) {
        mark_internal(copy);
    } else {
        forget_internal(copy);
    }
    if (closed) tell_others();
}

mode_t mode_argument(int flags, std::va_list arguments) {
    return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(arguments, mode_t) : 0;
}

/// open() of a named pipe waits in simulated time until somebody reads it. Deviation: for reading it does not
/// wait for a writer, the first read() does.
int open_named_pipe(const char* path, int flags) {
    mark_call("open");
    charge(page().charges.device);
    while (true) {
        const int fd = REAL(open)(path, flags | O_NONBLOCK);
        if (fd >= 0) {
            if ((flags & O_NONBLOCK) == 0) REAL(fcntl)(fd, F_SETFL, flags & O_ACCMODE);
            mark_internal(fd);
            tell_others();
            return fd;
        }
        if (errno != ENXIO || (flags & O_NONBLOCK) != 0) return fd;
        WaitOptions options;
        options.deadline = time_after(kExternalPeriod);
        options.interruptible = true;
        options.cancellable = true;
        if (park(external_key(), options) == Wake::Signal && !self()->restarts) return fail(EINTR);
    }
}

/// A pipe opened anew by the name of its descriptor is still one of the program's own.
int opened(const char* path, int fd) {
    int named = -1;
    if (fd < 0 || !active()) return fd;
    if (std::sscanf(path, "/dev/fd/%d", &named) != 1 && std::sscanf(path, "/proc/self/fd/%d", &named) != 1)
        return fd;
    if (is_internal(named)) mark_internal(fd);
    return fd;
}

/// A file that the board has and the host has not, or another one.
int open_made_file(const char* path) {
    if (const int uevent = open_video_uevent(path); uevent >= 0) return uevent;
    if (const int machine = open_machine_file(path); machine >= 0) return machine;
    return open_network_file(path);
}

/// The path does not depend on another folder than the working directory.
bool is_absolute_from(int folder, const char* path) {
    return folder == AT_FDCWD || (is_text(path) && path[0] == '/');
}

}  // namespace

SHIM_EXPORT int open(const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_of(path);
    if (const int made = open_made_file(path); made >= 0) return made;
    if (device == kNoDevice && is_named_pipe(path)) return opened(path, open_named_pipe(path, flags));
    return device == kNoDevice ? opened(path, REAL(open)(ProcessPath(path), flags, mode))
                               : open_device(device, flags);
}

SHIM_EXPORT int open64(const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_of(path);
    if (const int made = open_made_file(path); made >= 0) return made;
    if (device == kNoDevice && is_named_pipe(path)) return opened(path, open_named_pipe(path, flags));
    return device == kNoDevice ? opened(path, REAL(open64)(ProcessPath(path), flags, mode))
                               : open_device(device, flags);
}

SHIM_EXPORT int openat(int folder, const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_at(folder, path);
    if (const int made = open_made_file(path); made >= 0) return made;
    if (device == kNoDevice && is_absolute_from(folder, path) && is_named_pipe(path))
        return opened(path, open_named_pipe(path, flags));
    return device == kNoDevice ? opened(path, REAL(openat)(folder, ProcessPath(folder, path), flags, mode))
                               : open_device(device, flags);
}

SHIM_EXPORT int openat64(int folder, const char* path, int flags, ...) {
    std::va_list arguments;
    va_start(arguments, flags);
    const mode_t mode = mode_argument(flags, arguments);
    va_end(arguments);
    const int device = device_at(folder, path);
    if (const int made = open_made_file(path); made >= 0) return made;
    if (device == kNoDevice && is_absolute_from(folder, path) && is_named_pipe(path))
        return opened(path, open_named_pipe(path, flags));
    return device == kNoDevice ? opened(path, REAL(openat64)(folder, ProcessPath(folder, path), flags, mode))
                               : open_device(device, flags);
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
    if (active() && is_link_descriptor(fd)) return fail(EBADF);
    if (open_file(fd) != nullptr) release_file(fd);
    if (!active()) return REAL(close)(fd);
    const bool was_internal = is_internal(fd);
    drop_timer(fd);
    forget_internal(fd);
    const int result = REAL(close)(fd);
    if (was_internal) tell_others();  // the last writer's close is the reader's end
    return result;
}

SHIM_EXPORT void closefrom(int first) noexcept {
    if (!active()) return REAL(closefrom)(first);
    const auto last = static_cast<int>(sysconf(_SC_OPEN_MAX));
    for (int fd = first; fd < std::min(last, 4096); ++fd)
        close(fd);
}

SHIM_EXPORT int close_range(unsigned first, unsigned last, int flags) noexcept {
    if (active() && flags != 0) {  // close-on-exec: the link's descriptors are to stay
        for (unsigned fd = first; fd <= std::min(last, 4095u); ++fd)
            if (!is_link_descriptor(static_cast<int>(fd))) REAL(close_range)(fd, fd, flags);
        return 0;
    }
    if (!active()) return REAL(close_range)(first, last, flags);
    for (unsigned fd = first; fd <= std::min(last, 4095u); ++fd)
        close(static_cast<int>(fd));
    return 0;
}

SHIM_EXPORT int dup(int fd) noexcept {
    if (active() && is_link_descriptor(fd)) return fail(EBADF);
    const int copy = REAL(dup)(fd);
    if (copy >= 0 && active()) copied(fd, copy);
    return copy;
}

SHIM_EXPORT int dup3(int fd, int copy, int flags) noexcept {
    if (active() && (is_link_descriptor(copy) || is_link_descriptor(fd))) {
        errno = is_link_descriptor(fd) ? EBADF : EBUSY;
        return -1;
    }
    const int result = REAL(dup3)(fd, copy, flags);
    if (result >= 0 && active()) copied(fd, copy);
    return result;
}

SHIM_EXPORT int dup2(int fd, int copy) noexcept {
    if (active() && (is_link_descriptor(copy) || is_link_descriptor(fd))) {
        errno = is_link_descriptor(fd) ? EBADF : EBUSY;
        return -1;
    }
    const int result = REAL(dup2)(fd, copy);
    if (result >= 0 && active()) copied(fd, copy);
    return result;
}

namespace {
/// What the kernel sets for each open() of a 64-bit program; the C library's O_LARGEFILE is 0 there.
constexpr int kLargeFile = sizeof(long) == 8 ? 0100000 : O_LARGEFILE;
/// F_SETFL changes these.
constexpr int kSettableFlags = O_APPEND | O_NONBLOCK | O_NOATIME;

/// Locks of a device: only processes that know each other contend for it, and the host's file in its place is
/// everybody's.
int lock_device(int command, long argument) {
    struct flock lock {};
    auto* const theirs = reinterpret_cast<struct flock*>(argument);
    if (!get_from_program(lock, theirs)) return -1;
    if (lock.l_type != F_RDLCK && lock.l_type != F_WRLCK && lock.l_type != F_UNLCK) return fail(EINVAL);
    if (command != F_GETLK && command != F_OFD_GETLK) return 0;
    lock.l_type = F_UNLCK;
    return put_to_program(theirs, lock) ? 0 : -1;
}

bool is_about_owner(int command) {
    return command == F_SETOWN || command == F_GETOWN || command == F_SETOWN_EX || command == F_GETOWN_EX;
}

/// Who gets SIGIO and SIGURG: a process of the program's. Groups are not the host's.
int control_owner(int fd, int command, long argument, decltype(&::fcntl) real) {
    f_owner_ex owner{F_OWNER_PID, 0};
    auto* const theirs = reinterpret_cast<f_owner_ex*>(argument);
    if (command == F_GETOWN || command == F_GETOWN_EX) {
        if (real(fd, F_GETOWN_EX, &owner) != 0) return -1;
        if (owner.pid != 0) owner.pid = program_process(owner.pid);
        if (command == F_GETOWN) return owner.pid;
        return put_to_program(theirs, owner) ? 0 : -1;
    }
    if (command == F_SETOWN)
        owner.pid = static_cast<pid_t>(argument);
    else if (!get_from_program(owner, theirs))
        return -1;
    if (owner.type == F_OWNER_PGRP || owner.pid < 0) {
        note("signals of descriptors to a process group are not supported");
        return getpgid(owner.pid < 0 ? -owner.pid : owner.pid) < 0 ? -1 : 0;
    }
    const pid_t host = host_process(owner.pid);
    return host < 0 ? -1 : real(fd, F_SETOWN, static_cast<long>(host));
}

int control(int fd, int command, long argument, decltype(&::fcntl) real) {
    if (active() && is_link_descriptor(fd)) {
        if (command == F_SETFD) return 0;
        return fail(EBADF);
    }
    OpenFile* file = open_file(fd);
    switch (file != nullptr ? command : -1) {
    case F_GETFL:
        return file->flags | kLargeFile;
    case F_SETFL:
        charge(page().charges.device);
        if ((argument & O_DIRECT) != 0) return fail(EINVAL);
        if ((argument & O_ASYNC) != 0) note("%s: O_ASYNC (SIGIO) is not supported", file->path);
        file->flags = (file->flags & ~kSettableFlags) | static_cast<int>(argument & kSettableFlags);
        return 0;
    case F_GETLK:
    case F_SETLK:
    case F_SETLKW:
    case F_OFD_GETLK:
    case F_OFD_SETLK:
    case F_OFD_SETLKW:
        return lock_device(command, argument);
    case F_SETLEASE:
    case F_NOTIFY:
        if (command == F_NOTIFY && (argument & ~static_cast<long>(DN_MULTISHOT)) == 0) return 0;
        errno = command == F_NOTIFY ? ENOTDIR : EINVAL;
        return -1;
    default:
        break;
    }
    if (active() && thread_count() > 0 && (command == F_SETLKW || command == F_OFD_SETLKW))
        return wait_for_lock(fd, command, reinterpret_cast<void*>(argument));
    if (active() && is_about_owner(command)) return control_owner(fd, command, argument, real);
    const int result = real(fd, command, argument);
    if (active() && result == 0 && (command == F_GETLK || command == F_OFD_GETLK)) {
        auto* const lock = reinterpret_cast<struct flock*>(argument);
        if (lock->l_type != F_UNLCK && lock->l_pid > 0) lock->l_pid = program_process(lock->l_pid);
    }
    if (active() && result >= 0 && (command == F_DUPFD || command == F_DUPFD_CLOEXEC)) copied(fd, result);
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

namespace {
bool is_signal_descriptor(int fd) {
    char link[40], target[32];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const int error = errno;
    const long size = host_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(link),
                                reinterpret_cast<long>(target), sizeof target);
    errno = error;
    constexpr char kTarget[] = "anon_inode:[signalfd]";
    return size == sizeof kTarget - 1 && std::memcmp(target, kTarget, sizeof kTarget - 1) == 0;
}

/// What has been read into `buffer`: if it is signals, their senders are those of the board.
void show_senders(int fd, void* buffer, ssize_t size) {
    auto* const records = static_cast<signalfd_siginfo*>(buffer);
    constexpr ssize_t kSize = sizeof(signalfd_siginfo);
    if (!active() || size < kSize || size % kSize != 0 || records->ssi_signo >= NSIG) return;
    if (!is_signal_descriptor(fd)) return;
    for (ssize_t i = 0; i < size / kSize; ++i)
        show_origin(records[i]);
}
}  // namespace

SHIM_EXPORT ssize_t read(int fd, void* buffer, size_t size) {
    if (OpenFile* file = open_file(fd)) return read_device(*file, buffer, size);
    const ssize_t result = outside(fd, POLLIN, [&] { return REAL(read)(fd, buffer, size); });
    show_senders(fd, buffer, result);
    return result;
}

SHIM_EXPORT ssize_t __read_chk(int fd, void* buffer, size_t size, size_t room) {
    if (size > room) __builtin_trap();
    return read(fd, buffer, size);
}

SHIM_EXPORT ssize_t write(int fd, const void* data, size_t size) {
    if (OpenFile* file = open_file(fd)) return write_device(*file, data, size);
    if (size <= PIPE_BUF || goes_straight(fd) || !is_channel(fd))
        return outside(fd, POLLOUT, [&] { return REAL(write)(fd, data, size); });
    // A pipe with room for something takes no more than that without blocking in the host.
    ssize_t written = 0;
    while (static_cast<size_t>(written) < size) {
        const size_t part = std::min<size_t>(size - static_cast<size_t>(written), PIPE_BUF);
        const char* from = static_cast<const char*>(data) + written;
        const ssize_t result = outside(fd, POLLOUT, [&] { return REAL(write)(fd, from, part); });
        if (result < 0) return written > 0 ? written : result;
        written += result;
    }
    return written;
}

namespace {
/// The parts of readv() and writev(), checked as the kernel does.
struct Parts {
    std::vector<iovec> list;
    std::size_t size = 0;
};

bool get_parts(Parts& parts, const iovec* theirs, int count) {
    if (count < 0 || count > IOV_MAX) {
        errno = EINVAL;
        return false;
    }
    parts.list.resize(static_cast<std::size_t>(count));
    if (!copy_from_program(parts.list.data(), theirs, parts.list.size() * sizeof(iovec))) return false;
    for (const iovec& part : parts.list) {
        if (part.iov_len > SSIZE_MAX - parts.size) {
            errno = EINVAL;
            return false;
        }
        parts.size += part.iov_len;
    }
    return true;
}
}  // namespace

SHIM_EXPORT ssize_t readv(int fd, const iovec* theirs, int count) {
    OpenFile* file = open_file(fd);
    if (file == nullptr) {
        ssize_t left = outside(fd, POLLIN, [&] { return REAL(readv)(fd, theirs, count); });
        const ssize_t result = left;
        for (const iovec* part = theirs; left > 0; ++part) {
            const ssize_t size = std::min(left, static_cast<ssize_t>(part->iov_len));
            show_senders(fd, part->iov_base, size);
            left -= size;
        }
        return result;
    }
    Parts parts;
    if (!get_parts(parts, theirs, count)) return -1;
    std::vector<char> data(std::min<std::size_t>(parts.size, wire::kVideoBufferSize));
    const std::int64_t result = read_device(*file, data.data(), data.size());
    const char* cursor = data.data();
    std::int64_t left = result;
    for (const iovec& part : parts.list) {
        if (left <= 0) break;
        const auto size = std::min<std::size_t>(part.iov_len, static_cast<std::size_t>(left));
        if (!copy_to_program(part.iov_base, cursor, size)) return cursor > data.data() ? result - left : -1;
        cursor += size;
        left -= static_cast<std::int64_t>(size);
    }
    return result;
}

SHIM_EXPORT ssize_t writev(int fd, const iovec* theirs, int count) {
    OpenFile* file = open_file(fd);
    if (file == nullptr) return outside(fd, POLLOUT, [&] { return REAL(writev)(fd, theirs, count); });
    Parts parts;
    if (!get_parts(parts, theirs, count)) return -1;
    constexpr std::size_t kMost = std::size_t{1} << 20;  // the rest is another call's
    std::vector<char> data;
    for (const iovec& part : parts.list) {
        const std::size_t size = std::min(part.iov_len, kMost - data.size());
        const std::size_t before = data.size();
        if (readable_bytes(part.iov_base, size) < size) {
            if (before > 0) break;
            return fail(EFAULT);
        }
        data.resize(before + size);
        copy_from_program(data.data() + before, part.iov_base, size);
    }
    return write_device(*file, data.data(), data.size());
}
