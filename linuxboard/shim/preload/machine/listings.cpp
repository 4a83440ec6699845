// What folders hold that are other on the board: /proc has its processes and not the host's, /dev the devices
// of the scenario too, /proc/self/fd no descriptors of this library. Deviation: scandir() and glob() of the
// C library, which read folders past any library that is preloaded, show the host's.

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/descriptors/process_paths.h"
#include "linuxboard/shim/preload/host/host.h"
#include "linuxboard/shim/preload/host/link.h"
#include "linuxboard/shim/preload/host/process_numbers.h"
#include "linuxboard/shim/preload/host/real.h"
#include "linuxboard/shim/preload/scheduler/scheduler.h"

#include <dirent.h>
#include <fcntl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

using namespace puckloop::shim;

namespace {
struct Listing {
    enum class Kind { Processes, Devices, Descriptors };
    DIR* stream = nullptr;
    Kind kind = Kind::Processes;
    std::uint32_t next = 0;  ///< process slot or device to be shown next, once the host's entries are through
    bool seen[wire::kMaximumDevices] = {};  ///< devices that the host has, too
    dirent entry{};
};
constexpr int kMostListings = 16;
Listing listings[kMostListings];

Listing* listing_of(const DIR* stream) {
    for (Listing& listing : listings)
        if (listing.stream == stream && stream != nullptr) return &listing;
    return nullptr;
}

bool is_number(const char* text) {
    return *text != '\0' && text[std::strspn(text, "0123456789")] == '\0';
}

DIR* begin_listing(DIR* stream) {
    if (stream == nullptr || !active()) return stream;
    const int error = errno;
    char link[40], path[80];
    std::snprintf(link, sizeof link, "/proc/self/fd/%d", dirfd(stream));
    const long size = host_call(SYS_readlinkat, AT_FDCWD, reinterpret_cast<long>(link),
                                reinterpret_cast<long>(path), sizeof path - 1);
    errno = error;
    if (size <= 0) return stream;
    path[size] = '\0';
    int process = 0, end = 0;
    const bool descriptors = std::sscanf(path, "/proc/%d/fd%n", &process, &end) == 1 && end == size &&
                             program_process(process) != 0;
    Listing begun;
    begun.stream = stream;
    if (std::strcmp(path, "/proc") == 0) {
        begun.kind = Listing::Kind::Processes;
    } else if (std::strcmp(path, "/dev") == 0) {
        begun.kind = Listing::Kind::Devices;
    } else if (descriptors) {
        begun.kind = Listing::Kind::Descriptors;
    } else {
        return stream;
    }
    for (Listing& listing : listings) {
        if (listing.stream != nullptr) continue;
        listing = begun;
        break;
    }
    return stream;
}

/// The name of a device directly in /dev, or nullptr.
const char* name_in_dev(const wire::DeviceName& device) {
    constexpr char kFolder[] = "/dev/";
    if (device.kind == wire::DeviceKind::None || std::strncmp(device.path, kFolder, sizeof kFolder - 1) != 0)
        return nullptr;
    const char* name = device.path + sizeof kFolder - 1;
    return std::strchr(name, '/') == nullptr ? name : nullptr;
}

/// An entry of the host's that the board has, too.
bool shows(Listing& listing, const dirent& entry) {
    switch (listing.kind) {
    case Listing::Kind::Processes:
        return !is_number(entry.d_name);
    case Listing::Kind::Descriptors:
        return !is_number(entry.d_name) || !is_link_descriptor(std::atoi(entry.d_name));
    case Listing::Kind::Devices:
        for (std::uint32_t i = 0; i < wire::kMaximumDevices; ++i) {
            const char* name = name_in_dev(page().devices[i]);
            if (name != nullptr && std::strcmp(name, entry.d_name) == 0) listing.seen[i] = true;
        }
        break;
    }
    return true;
}

/// What the host has not: one entry, or nullptr when all have been shown.
dirent* next_of_board(Listing& listing) {
    dirent& entry = listing.entry;
    entry = {};
    entry.d_reclen = sizeof entry;
    while (listing.kind == Listing::Kind::Processes && listing.next < wire::kMaximumProcesses) {
        const wire::ProcessEntry& process = page().processes[listing.next++];
        if (process.state == wire::ProcessEntry::Free) continue;
        std::snprintf(entry.d_name, sizeof entry.d_name, "%d", process.number);
        entry.d_ino = static_cast<ino_t>(process.number);
        entry.d_type = DT_DIR;
        return &entry;
    }
    while (listing.kind == Listing::Kind::Devices && listing.next < wire::kMaximumDevices) {
        const std::uint32_t device = listing.next++;
        const char* name = name_in_dev(page().devices[device]);
        if (name == nullptr || listing.seen[device]) continue;
        std::snprintf(entry.d_name, sizeof entry.d_name, "%s", name);
        constexpr ino_t kFirstNumber = 1;
        entry.d_ino = kFirstNumber + device;
        entry.d_type = DT_CHR;
        return &entry;
    }
    return nullptr;
}

dirent* next_entry(DIR* stream) {
    Listing* listing = active() ? listing_of(stream) : nullptr;
    if (listing == nullptr) return REAL(readdir)(stream);
    while (dirent* entry = listing->next == 0 ? REAL(readdir)(stream) : nullptr)
        if (shows(*listing, *entry)) return entry;
    return next_of_board(*listing);
}
}  // namespace

SHIM_EXPORT DIR* opendir(const char* path) {
    return begin_listing(REAL(opendir)(ProcessPath(path)));
}
SHIM_EXPORT DIR* fdopendir(int fd) {
    return begin_listing(REAL(fdopendir)(fd));
}
SHIM_EXPORT dirent* readdir(DIR* stream) {
    return next_entry(stream);
}
SHIM_EXPORT dirent64* readdir64(DIR* stream) {
    static_assert(sizeof(dirent64) == sizeof(dirent));
    return reinterpret_cast<dirent64*>(next_entry(stream));
}
SHIM_EXPORT void rewinddir(DIR* stream) noexcept {
    if (Listing* listing = listing_of(stream)) listing->next = 0;
    REAL(rewinddir)(stream);
}
SHIM_EXPORT int closedir(DIR* stream) {
    if (Listing* listing = listing_of(stream)) *listing = {};
    return REAL(closedir)(stream);
}
