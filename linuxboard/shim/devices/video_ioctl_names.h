#pragma once
// The names of V4L2's ioctls, for the report.

#include <cstdint>

namespace puckloop::linuxboard {

/// "VIDIOC_DQBUF", or nullptr for a number that V4L2 does not have.
const char* video_ioctl_name(std::uint32_t request);

}  // namespace puckloop::linuxboard
