#include "linuxboard/shim/preload/descriptors/video_names.h"

#include "linuxboard/shim/preload/descriptors/open_file.h"
#include "linuxboard/shim/preload/host/program_memory.h"
#include "linuxboard/shim/preload/host/real.h"

#include <sys/mman.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace puckloop::shim {

int video_minor(const char* path) {
    const int device = device_of(path);
    if (device < 0 || page().devices[device].kind != wire::DeviceKind::Video) return -1;
    const char* digits = path + std::strlen(path);
    while (digits > path && digits[-1] >= '0' && digits[-1] <= '9')
        --digits;
    return *digits == '\0' ? device : std::atoi(digits);
}

int open_video_uevent(const char* path) {
    constexpr char kStart[] = "/sys/dev/char/81:";
    if (!is_linked() || !is_text(path) || std::strncmp(path, kStart, sizeof kStart - 1) != 0) return -1;
    for (const wire::DeviceName& device : page().devices) {
        if (device.kind != wire::DeviceKind::Video) continue;
        const int number = video_minor(device.path);
        char name[64];
        std::snprintf(name, sizeof name, "%s%d/uevent", kStart, number);
        if (number < 0 || std::strcmp(path, name) != 0) continue;
        char text[160];
        const int size = std::snprintf(text, sizeof text, "MAJOR=%d\nMINOR=%d\nDEVNAME=video%d\n",
                                       kVideoMajor, number, number);
        const int fd = memfd_create("uevent", MFD_CLOEXEC);
        if (fd < 0) return -1;
        const bool written = REAL(write)(fd, text, static_cast<std::size_t>(size)) == size;
        lseek(fd, 0, SEEK_SET);
        if (written) return fd;
        REAL(close)(fd);
        return -1;
    }
    return -1;
}

}  // namespace puckloop::shim
