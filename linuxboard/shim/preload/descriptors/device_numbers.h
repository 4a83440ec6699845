#pragma once
// What stat() shows of a device.

#include "linuxboard/shim/preload/descriptors/open_file.h"

#include <sys/stat.h>
#include <sys/sysmacros.h>

namespace puckloop::shim {

/// Major and minor number as the kernel and udev give them for a name like /dev/ttyS0 (devices.txt).
dev_t device_number(const char* path);
inline dev_t device_number(const OpenFile& file) {
    return device_number(file.path);
}

inline constexpr unsigned kDeviceMode = S_IFCHR | S_IRUSR | S_IWUSR | S_IRGRP | S_IWGRP;

/// Makes what the host reports of the stand-in that of the device.
template <typename Status>
void show_device(Status& status, const char* path) {
    status.st_mode = kDeviceMode;
    status.st_rdev = device_number(path);
}

}  // namespace puckloop::shim
