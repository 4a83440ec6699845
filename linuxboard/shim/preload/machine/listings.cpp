// What folders hold that are other on the board: /proc has its processes and not the host's, /dev the devices
// of the scenario too, /proc/self/fd no descriptors of this library. All ways to list a folder end in
// getdents64(), the C library's own too (libc_hooks.cpp): readdir(), scandir(), glob(), nftw(), fts_read().
// Deviation: nftw() and fts_read() open the folders below one relative to it, past this library, and so come
// not into /proc/NUMBER; nftw() ends there.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/descriptors/process_paths.h"
#include "linuxboard/shim/preload/host/failure.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace puckloop::shim;

namespace {
enum class Folder { Other, Processes, Devices, Descriptors };

/// Places of the board's own entries in a folder, behind all of the host's: process number or device. The
/// kernel keeps the place with the open folder, so that rewinddir(), seekdir(), dup() and fork() need
/// nothing.
constexpr off_t kOwnEntries = off_t{1} << 30, kMostOwnEntries = off_t{1} << 29;

bool is_number(const char* text) {
    return *text != '\0' && text[std::strspn(text, "0123456789")] == '\0';
}

Folder folder_of(int fd) {
    const int error = errno;
    char link[40], path[80];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
    const long size = host_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(link),
                                reinterpret_cast<long>(path), sizeof path - 1);
    errno = error;
    if (size <= 0) return Folder::Other;
    path[size] = '\0';
    if (std::strcmp(path, "/proc") == 0) return Folder::Processes;
    if (std::strcmp(path, "/dev") == 0) return Folder::Devices;
    int process = 0, end = 0;
    const bool descriptors = std::sscanf(path, "/proc/%d/fd%n", &process, &end) == 1 && end == size &&
                             program_process(process) != 0;
    return descriptors ? Folder::Descriptors : Folder::Other;
}

/// An entry of the host's that the board has not.
bool hides(Folder folder, const char* name) {
    if (!is_number(name)) return false;
    return folder == Folder::Processes ||
           (folder == Folder::Descriptors && is_link_descriptor(std::atoi(name)));
}

/// Takes the hidden entries out; returns the bytes that are left.
ssize_t without_hidden(Folder folder, char* entries, ssize_t size) {
    ssize_t kept = 0;
    for (ssize_t at = 0; at < size;) {
        auto* const entry = reinterpret_cast<dirent64*>(entries + at);
        const ssize_t length = entry->d_reclen;
        if (!hides(folder, entry->d_name)) {
            std::memmove(entries + kept, entry, static_cast<std::size_t>(length));
            kept += length;
        }
        at += length;
    }
    return kept;
}

/// The name of a device directly in /dev that the host has not, or nullptr.
const char* name_of_device(std::uint32_t index) {
    const wire::DeviceName& device = page().devices[index];
    constexpr char kFolder[] = "/dev/";
    if (device.kind == wire::DeviceKind::None || std::strncmp(device.path, kFolder, sizeof kFolder - 1) != 0)
        return nullptr;
    const char* name = device.path + sizeof kFolder - 1;
    if (std::strchr(name, '/') != nullptr) return nullptr;
    const int error = errno;
    const bool shown = host_call(SYS_faccessat, AT_FDCWD, reinterpret_cast<long>(device.path), F_OK) == 0;
    errno = error;
    return shown ? nullptr : name;
}

struct Own {
    off_t place = -1;  ///< -1: there is none
    char name[wire::kNameLength] = {};
    unsigned char type = DT_UNKNOWN;
};

/// The board's first entry from `place` on.
Own own_entry(Folder folder, off_t place) {
    Own own;
    if (folder == Folder::Processes) {
        for (const wire::ProcessEntry& process : page().processes) {
            const off_t number = process.number;
            if (process.state == wire::ProcessEntry::Free || number < place) continue;
            if (own.place < 0 || number < own.place) own.place = number;
        }
        own.type = DT_DIR;
        std::snprintf(own.name, sizeof own.name, "%lld", static_cast<long long>(own.place));
    } else if (folder == Folder::Devices) {
        for (off_t device = place; device < wire::kMaximumDevices; ++device) {
            const char* name = name_of_device(static_cast<std::uint32_t>(device));
            if (name == nullptr) continue;
            own.place = device;
            own.type = DT_CHR;
            std::snprintf(own.name, sizeof own.name, "%s", name);
            break;
        }
    }
    return own;
}

/// As many of the board's entries from `place` on as there is room for.
ssize_t own_entries(Folder folder, int fd, off_t place, void* theirs, std::size_t room) {
    char list[4096];
    room = std::min(room, sizeof list);
    std::size_t used = 0;
    Own own = own_entry(folder, place);
    while (own.place >= 0) {
        constexpr std::size_t kHead = offsetof(dirent64, d_name), kAligned = alignof(dirent64);
        const std::size_t length = (kHead + std::strlen(own.name) + 1 + kAligned - 1) / kAligned * kAligned;
        if (used + length > room) break;
        auto* const entry = reinterpret_cast<dirent64*>(list + used);
        std::memset(list + used, 0, length);
        place = own.place + 1;
        entry->d_ino = static_cast<ino64_t>(place);
        entry->d_off = kOwnEntries + place;
        entry->d_reclen = static_cast<unsigned short>(length);
        entry->d_type = own.type;
        std::memcpy(list + used + kHead, own.name, std::strlen(own.name));
        used += length;
        own = own_entry(folder, place);
    }
    if (used == 0 && own.place >= 0) return fail(EINVAL);
    if (REAL(lseek)(fd, kOwnEntries + place, SEEK_SET) < 0) return 0;
    return copy_to_program(theirs, list, used) ? static_cast<ssize_t>(used) : -1;
}
}  // namespace

SHIM_EXPORT ssize_t getdents64(int fd, void* entries, size_t room) noexcept {
    const Folder folder = active() ? folder_of(fd) : Folder::Other;
    if (folder == Folder::Other) return REAL(getdents64)(fd, entries, room);
    off_t place = REAL(lseek)(fd, 0, SEEK_CUR) - kOwnEntries;
    if (place < 0 || place >= kMostOwnEntries) {
        while (true) {
            const ssize_t size = REAL(getdents64)(fd, entries, room);
            if (size < 0) return size;
            if (size == 0) break;
            const ssize_t kept = without_hidden(folder, static_cast<char*>(entries), size);
            if (kept > 0) return kept;
        }
        place = 0;
    }
    return folder == Folder::Descriptors ? 0 : own_entries(folder, fd, place, entries, room);
}

SHIM_EXPORT DIR* opendir(const char* path) {
    if (device_of(path) != kNoDevice) {
        errno = ENOTDIR;
        return nullptr;
    }
    return REAL(opendir)(ProcessPath(path));
}
