// Extended attributes of devices: there are none, and none can be set. Tools that list files ask for them.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/descriptors/process_paths.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/real.h"

#include <sys/xattr.h>

#include <cerrno>
#include <fcntl.h>

using namespace puckloop::shim;

namespace {
bool is_device(const char* path, bool follow) {
    const int device = device_at(AT_FDCWD, path, follow);
    return device >= 0 || device == kRandomDevice;
}
bool is_device(int fd) {
    return open_file(fd) != nullptr;
}
}  // namespace

SHIM_EXPORT ssize_t getxattr(const char* path, const char* name, void* value, size_t size) noexcept {
    return is_device(path, true) ? fail(ENODATA) : REAL(getxattr)(ProcessPath(path), name, value, size);
}
SHIM_EXPORT ssize_t lgetxattr(const char* path, const char* name, void* value, size_t size) noexcept {
    return is_device(path, false) ? fail(ENODATA) : REAL(lgetxattr)(ProcessPath(path), name, value, size);
}
SHIM_EXPORT ssize_t fgetxattr(int fd, const char* name, void* value, size_t size) noexcept {
    return is_device(fd) ? fail(ENODATA) : REAL(fgetxattr)(fd, name, value, size);
}
SHIM_EXPORT ssize_t listxattr(const char* path, char* list, size_t size) noexcept {
    return is_device(path, true) ? 0 : REAL(listxattr)(ProcessPath(path), list, size);
}
SHIM_EXPORT ssize_t llistxattr(const char* path, char* list, size_t size) noexcept {
    return is_device(path, false) ? 0 : REAL(llistxattr)(ProcessPath(path), list, size);
}
SHIM_EXPORT ssize_t flistxattr(int fd, char* list, size_t size) noexcept {
    return is_device(fd) ? 0 : REAL(flistxattr)(fd, list, size);
}
SHIM_EXPORT int setxattr(const char* path, const char* name, const void* value, size_t size,
                         int flags) noexcept {
    return is_device(path, true) ? fail(EPERM) : REAL(setxattr)(path, name, value, size, flags);
}
SHIM_EXPORT int lsetxattr(const char* path, const char* name, const void* value, size_t size,
                          int flags) noexcept {
    return is_device(path, false) ? fail(EPERM) : REAL(lsetxattr)(path, name, value, size, flags);
}
SHIM_EXPORT int fsetxattr(int fd, const char* name, const void* value, size_t size, int flags) noexcept {
    return is_device(fd) ? fail(EPERM) : REAL(fsetxattr)(fd, name, value, size, flags);
}
SHIM_EXPORT int removexattr(const char* path, const char* name) noexcept {
    return is_device(path, true) ? fail(EPERM) : REAL(removexattr)(path, name);
}
SHIM_EXPORT int lremovexattr(const char* path, const char* name) noexcept {
    return is_device(path, false) ? fail(EPERM) : REAL(lremovexattr)(path, name);
}
SHIM_EXPORT int fremovexattr(int fd, const char* name) noexcept {
    return is_device(fd) ? fail(EPERM) : REAL(fremovexattr)(fd, name);
}
