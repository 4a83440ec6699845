// Which device a path names: by the name that the scenario gives it, however the path is written, through
// symbolic links, and as a descriptor of this process in /dev/fd or /proc.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/path.h"
#include "linuxboard/shim/preload/host/program_memory.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

int named_descriptor(const char* path) {
    if (std::strcmp(path, "/dev/stdin") == 0) return STDIN_FILENO;
    if (std::strcmp(path, "/dev/stdout") == 0) return STDOUT_FILENO;
    if (std::strcmp(path, "/dev/stderr") == 0) return STDERR_FILENO;
    char own_folder[40];
    std::snprintf(own_folder, sizeof own_folder, "/proc/%d/fd/", own().number);
    const char* const folders[] = {"/dev/fd/", "/proc/self/fd/", "/proc/thread-self/fd/", own_folder};
    for (const char* folder : folders) {
        const std::size_t size = std::strlen(folder);
        if (std::strncmp(path, folder, size) != 0 || path[size] < '0' || path[size] > '9') continue;
        char* end = nullptr;
        const long fd = std::strtol(path + size, &end, 10);
        return *end == '\0' && fd < INT_MAX ? static_cast<int>(fd) : -1;
    }
    return -1;
}

namespace {
constexpr const char* kRandomPaths[] = {"/dev/urandom", "/dev/random"};
constexpr int kMostLinks = 8;

int forbidden_unless_active(int device) {
    return active() ? device : kForbiddenDevice;
}

/// By its exact name.
int named(const char* path) {
    for (const char* random : kRandomPaths)
        if (std::strcmp(path, random) == 0) return active() ? kRandomDevice : kNoDevice;
    for (std::uint32_t i = 0; i < wire::kMaximumDevices; ++i) {
        const wire::DeviceName& device = page().devices[i];
        if (device.kind != wire::DeviceKind::None && std::strcmp(path, device.path) == 0)
            return forbidden_unless_active(static_cast<int>(device.device));
    }
    return kNoDevice;
}

bool ends_like_a_device(const char* path) {
    const char* last = last_part(path);
    for (const char* random : kRandomPaths)
        if (std::strcmp(last, last_part(random)) == 0) return true;
    for (const wire::DeviceName& device : page().devices)
        if (device.kind != wire::DeviceKind::None && std::strcmp(last, last_part(device.path)) == 0)
            return true;
    return false;
}

/// `path` from `folder` on, without ".", ".." and double slashes; false if it has no room.
bool make_absolute(int folder, const char* path, char (&out)[PATH_MAX]) {
    char whole[2 * PATH_MAX];
    if (path[0] == '/') {
        std::snprintf(whole, sizeof whole, "%s", path);
    } else {
        char name[40] = "/proc/self/cwd";
        if (folder != AT_FDCWD) std::snprintf(name, sizeof name, "/proc/self/fd/%d", folder);
        char base[PATH_MAX];
        const long size = host_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(name),
                                    reinterpret_cast<long>(base), sizeof base - 1);
        if (size <= 0) return false;
        base[size] = '\0';
        std::snprintf(whole, sizeof whole, "%s/%s", base, path);
    }
    std::size_t used = 0;
    for (const char* part = whole; *part != '\0';) {
        part += std::strspn(part, "/");
        const std::size_t size = std::strcspn(part, "/");
        if (size == 2 && std::strncmp(part, "..", 2) == 0) {
            while (used > 0 && out[--used] != '/') {
            }
        } else if (size > 0 && !(size == 1 && *part == '.')) {
            if (used + size + 2 > sizeof out) return false;
            out[used++] = '/';
            std::memcpy(out + used, part, size);
            used += size;
        }
        part += size;
    }
    out[used] = '\0';
    return true;
}

int look_up(int folder, const char* path, int links) {  // `links`: how many were followed
    if (const int device = named(path); device != kNoDevice) return device;
    if (const int fd = named_descriptor(path); fd >= 0) {
        const OpenFile* file = open_file(fd);
        if (file == nullptr) return kNoDevice;
        return file->kind == OpenFile::Kind::Random ? kRandomDevice : file->device;
    }
    char absolute[PATH_MAX];
    if (ends_like_a_device(path) && make_absolute(folder, path, absolute))
        if (const int device = named(absolute); device != kNoDevice) return device;
    char target[PATH_MAX];
    const long size = host_call(SYS_readlinkat, folder, reinterpret_cast<long>(path),
                                reinterpret_cast<long>(target), sizeof target - 1);
    if (size <= 0 || links == kMostLinks) return kNoDevice;
    target[size] = '\0';
    if (target[0] == '/') return look_up(AT_FDCWD, target, links + 1);
    char beside[2 * PATH_MAX];
    std::snprintf(beside, sizeof beside, "%.*s%s", static_cast<int>(last_part(path) - path), path, target);
    return look_up(folder, beside, links + 1);
}
}  // namespace

int device_at(int folder, const char* path, bool follow) {
    if (!is_linked() || !is_text(path)) return kNoDevice;
    const int error = errno;
    const int device = look_up(folder, path, follow ? 0 : kMostLinks);
    errno = error;
    return device;
}

int device_of(const char* path) {
    return device_at(AT_FDCWD, path);
}

}  // namespace puckloop::shim
