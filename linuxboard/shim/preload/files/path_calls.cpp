// A program that looks for its device before it opens it finds the one it will get, with the mode and number
// that it has on the board. What it changes of it (owner, mode, times) is accepted and has no effect: behind
// a device lies a file that is the whole host's.

#include "linuxboard/shim/preload/descriptors/device_numbers.h"
#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/descriptors/process_paths.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"

#include <fcntl.h>
#include <stdio.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <sys/time.h>
#include <unistd.h>
#include <utime.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

using namespace puckloop::shim;

extern "C" {
int __xstat(int, const char*, struct stat*) noexcept;
int __xstat64(int, const char*, struct stat64*) noexcept;
int __lxstat(int, const char*, struct stat*) noexcept;
int __lxstat64(int, const char*, struct stat64*) noexcept;
int __fxstat(int, int, struct stat*) noexcept;
int __fxstat64(int, int, struct stat64*) noexcept;
}

namespace {
constexpr const char* kStandIn = "/dev/null";

/// The device's name in the scenario, or nullptr.
const char* device_name(int folder, const char* path, bool follow = true) {
    const int device = device_at(folder, path, follow);
    if (device >= 0) return page().devices[device].path;
    return device == kRandomDevice ? "/dev/urandom" : nullptr;
}
const char* device_name(const char* path) {
    return device_name(AT_FDCWD, path);
}
const char* device_name(int fd) {
    const OpenFile* file = open_file(fd);
    const bool device = file != nullptr && file->kind != OpenFile::Kind::Socket;  // that is one of the host's
    return device ? file->path : nullptr;
}
/// With AT_EMPTY_PATH the folder itself is meant.
const char* device_name(int folder, const char* path, int flags) {
    const bool itself = (flags & AT_EMPTY_PATH) != 0 && (path == nullptr || (is_text(path) && *path == '\0'));
    return itself ? device_name(folder) : device_name(folder, path, (flags & AT_SYMLINK_NOFOLLOW) == 0);
}

template <typename Status>
int shown(const char* name, Status* status, int result) {
    if (result == 0 && name != nullptr) show_device(*status, name);
    return result;
}

/// A device itself, no link to one.
bool is_device(int folder, const char* path) {
    return device_name(folder, path, false) != nullptr;
}

/// `path` as the host has it: the stand-in of device `name`, in a process's folder, or as it is.
ProcessPath on_host(const char* path, const char* name) {
    return ProcessPath(name != nullptr ? kStandIn : path);
}

int refused_change() {
    return fail(EPERM);
}
}  // namespace

SHIM_EXPORT int access(const char* path, int mode) noexcept {
    return REAL(access)(on_host(path, device_name(path)), mode);
}
SHIM_EXPORT int faccessat(int folder, const char* path, int mode, int flags) noexcept {
    return REAL(faccessat)(folder, on_host(path, device_name(folder, path)), mode, flags);
}
SHIM_EXPORT int euidaccess(const char* path, int mode) noexcept {
    return REAL(euidaccess)(on_host(path, device_name(path)), mode);
}
SHIM_EXPORT int eaccess(const char* path, int mode) noexcept {
    return euidaccess(path, mode);
}

#define STAT_OF_PATH(call, type)                                                                             \
    SHIM_EXPORT int call(const char* path, type* status) noexcept {                                          \
        const char* name = device_name(path);                                                                \
        return shown(name, status, REAL(call)(on_host(path, name), status));                                 \
    }                                                                                                        \
    SHIM_EXPORT int __x##call(int version, const char* path, type* status) noexcept {                        \
        const char* name = device_name(path);                                                                \
        return shown(name, status, REAL(__x##call)(version, on_host(path, name), status));                   \
    }
#define STAT_OF_LINK(call, type)                                                                             \
    SHIM_EXPORT int l##call(const char* path, type* status) noexcept {                                       \
        const char* name = device_name(AT_FDCWD, path, false);                                               \
        return shown(name, status, REAL(l##call)(on_host(path, name), status));                              \
    }                                                                                                        \
    SHIM_EXPORT int __lx##call(int version, const char* path, type* status) noexcept {                       \
        const char* name = device_name(AT_FDCWD, path, false);                                               \
        return shown(name, status, REAL(__lx##call)(version, on_host(path, name), status));                  \
    }
#define STAT_OF_DESCRIPTOR(call, type)                                                                       \
    SHIM_EXPORT int f##call(int fd, type* status) noexcept {                                                 \
        return shown(device_name(fd), status, REAL(f##call)(fd, status));                                    \
    }                                                                                                        \
    SHIM_EXPORT int __fx##call(int version, int fd, type* status) noexcept {                                 \
        return shown(device_name(fd), status, REAL(__fx##call)(version, fd, status));                        \
    }
using Stat = struct stat;
using Stat64 = struct stat64;
STAT_OF_PATH(stat, Stat)
STAT_OF_PATH(stat64, Stat64)
STAT_OF_LINK(stat, Stat)
STAT_OF_LINK(stat64, Stat64)
STAT_OF_DESCRIPTOR(stat, Stat)
STAT_OF_DESCRIPTOR(stat64, Stat64)

SHIM_EXPORT int fstatat(int folder, const char* path, struct stat* status, int flags) noexcept {
    const char* name = device_name(folder, path, flags);
    if (name != nullptr) return shown(name, status, REAL(stat)(kStandIn, status));
    return REAL(fstatat)(folder, ProcessPath(folder, path), status, flags);
}
SHIM_EXPORT int fstatat64(int folder, const char* path, struct stat64* status, int flags) noexcept {
    const char* name = device_name(folder, path, flags);
    if (name != nullptr) return shown(name, status, REAL(stat64)(kStandIn, status));
    return REAL(fstatat64)(folder, ProcessPath(folder, path), status, flags);
}
SHIM_EXPORT int statx(int folder, const char* path, int flags, unsigned mask, struct statx* status) noexcept {
    const char* name = device_name(folder, path, flags);
    if (name == nullptr) return REAL(statx)(folder, ProcessPath(folder, path), flags, mask, status);
    const int result = REAL(statx)(AT_FDCWD, kStandIn, 0, mask, status);
    if (result != 0) return result;
    const dev_t number = device_number(name);
    status->stx_mode = static_cast<decltype(status->stx_mode)>(kDeviceMode);
    status->stx_rdev_major = major(number);
    status->stx_rdev_minor = minor(number);
    return 0;
}

// What is changed.
SHIM_EXPORT int chmod(const char* path, mode_t mode) noexcept {
    return device_name(path) != nullptr ? 0 : REAL(chmod)(path, mode);
}
SHIM_EXPORT int fchmod(int fd, mode_t mode) noexcept {
    return device_name(fd) != nullptr ? 0 : REAL(fchmod)(fd, mode);
}
SHIM_EXPORT int fchmodat(int folder, const char* path, mode_t mode, int flags) noexcept {
    return device_name(folder, path) != nullptr ? 0 : REAL(fchmodat)(folder, path, mode, flags);
}
SHIM_EXPORT int chown(const char* path, uid_t user, gid_t group) noexcept {
    return device_name(path) != nullptr ? 0 : REAL(chown)(path, user, group);
}
SHIM_EXPORT int lchown(const char* path, uid_t user, gid_t group) noexcept {
    return is_device(AT_FDCWD, path) ? 0 : REAL(lchown)(path, user, group);
}
SHIM_EXPORT int fchown(int fd, uid_t user, gid_t group) noexcept {
    return device_name(fd) != nullptr ? 0 : REAL(fchown)(fd, user, group);
}
SHIM_EXPORT int fchownat(int folder, const char* path, uid_t user, gid_t group, int flags) noexcept {
    if (device_name(folder, path, flags) != nullptr) return 0;
    return REAL(fchownat)(folder, path, user, group, flags);
}
SHIM_EXPORT int utimensat(int folder, const char* path, const timespec* times, int flags) noexcept {
    const bool device =
        path == nullptr ? device_name(folder) != nullptr : device_name(folder, path) != nullptr;
    return device ? 0 : REAL(utimensat)(folder, path, times, flags);
}
SHIM_EXPORT int futimens(int fd, const timespec* times) noexcept {
    return device_name(fd) != nullptr ? 0 : REAL(futimens)(fd, times);
}
SHIM_EXPORT int futimes(int fd, const timeval* times) noexcept {
    return device_name(fd) != nullptr ? 0 : REAL(futimes)(fd, times);
}
SHIM_EXPORT int utimes(const char* path, const timeval* times) noexcept {
    return device_name(path) != nullptr ? 0 : REAL(utimes)(path, times);
}
SHIM_EXPORT int utime(const char* path, const utimbuf* times) noexcept {
    return device_name(path) != nullptr ? 0 : REAL(utime)(path, times);
}

// A device's name stays: the board's are the scenario's, the host's are none of the program's business.
SHIM_EXPORT int unlink(const char* path) noexcept {
    return is_device(AT_FDCWD, path) ? refused_change() : REAL(unlink)(path);
}
SHIM_EXPORT int unlinkat(int folder, const char* path, int flags) noexcept {
    return is_device(folder, path) ? refused_change() : REAL(unlinkat)(folder, path, flags);
}
SHIM_EXPORT int rename(const char* from, const char* to) noexcept {
    if (is_device(AT_FDCWD, from) || is_device(AT_FDCWD, to)) return refused_change();
    return REAL(rename)(from, to);
}
SHIM_EXPORT int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
    if (is_device(from_folder, from) || is_device(to_folder, to)) return refused_change();
    return REAL(renameat)(from_folder, from, to_folder, to);
}
SHIM_EXPORT int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                          unsigned flags) noexcept {
    if (is_device(from_folder, from) || is_device(to_folder, to)) return refused_change();
    return REAL(renameat2)(from_folder, from, to_folder, to, flags);
}
SHIM_EXPORT int truncate(const char* path, off_t size) noexcept {
    if (device_name(path) == nullptr) return REAL(truncate)(path, size);
    return fail(EINVAL);
}
SHIM_EXPORT int truncate64(const char* path, off64_t size) noexcept {
    return truncate(path, size);
}
