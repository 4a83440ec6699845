#pragma once
// Cameras by their device numbers: tools such as v4l2-ctl ask the file system what a device is before they
// open it.

#include <sys/stat.h>

namespace puckloop::shim {

inline constexpr int kVideoMajor = 81;

/// Minor device number of a camera, as udev gives it: the number in its name. -1: the path is none.
int video_minor(const char* path);
/// A descriptor of /sys/dev/char/81:N/uevent of a camera, or -1 with errno unchanged if the path is none.
int open_video_uevent(const char* path);

}  // namespace puckloop::shim
