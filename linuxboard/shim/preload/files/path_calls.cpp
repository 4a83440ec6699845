// A program that looks for its device before it opens it finds the one it will get.

#include "linuxboard/shim/preload/files/open_file.h"
#include "linuxboard/shim/preload/files/video_names.h"
#include "linuxboard/shim/preload/real.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

using namespace puckloop::shim;

namespace {
const char* stand_in(const char* path) {
    return device_of(path) == kNoDevice ? path : "/dev/null";
}

template <typename Status>
int numbered(const char* path, Status* status, int result) {
    const int camera = result == 0 ? video_minor(path) : -1;
    if (camera >= 0) status->st_rdev = makedev(kVideoMajor, camera);
    return result;
}
}  // namespace

SHIM_EXPORT int access(const char* path, int mode) noexcept {
    return REAL(access)(stand_in(path), mode);
}
SHIM_EXPORT int faccessat(int folder, const char* path, int mode, int flags) noexcept {
    return REAL(faccessat)(folder, stand_in(path), mode, flags);
}
SHIM_EXPORT int stat(const char* path, struct stat* status) noexcept {
    return numbered(path, status, REAL(stat)(stand_in(path), status));
}
SHIM_EXPORT int stat64(const char* path, struct stat64* status) noexcept {
    return numbered(path, status, REAL(stat64)(stand_in(path), status));
}
SHIM_EXPORT int lstat(const char* path, struct stat* status) noexcept {
    return numbered(path, status, REAL(lstat)(stand_in(path), status));
}
SHIM_EXPORT int lstat64(const char* path, struct stat64* status) noexcept {
    return numbered(path, status, REAL(lstat64)(stand_in(path), status));
}
SHIM_EXPORT int fstatat(int folder, const char* path, struct stat* status, int flags) noexcept {
    return numbered(path, status, REAL(fstatat)(folder, stand_in(path), status, flags));
}
SHIM_EXPORT int fstatat64(int folder, const char* path, struct stat64* status, int flags) noexcept {
    return numbered(path, status, REAL(fstatat64)(folder, stand_in(path), status, flags));
}
SHIM_EXPORT int statx(int folder, const char* path, int flags, unsigned mask, struct statx* status) noexcept {
    const int result = REAL(statx)(folder, stand_in(path), flags, mask, status);
    const int camera = result == 0 ? video_minor(path) : -1;
    if (camera >= 0) {
        status->stx_rdev_major = kVideoMajor;
        status->stx_rdev_minor = static_cast<unsigned>(camera);
    }
    return result;
}
