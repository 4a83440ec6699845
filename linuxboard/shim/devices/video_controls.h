#pragma once
// The controls of a camera (VIDIOC_QUERYCTRL and its kin). Exposure is fixed and has none: the driver of the
// robot's camera refuses it too (ARGoS, epuck_image_grabber).

#include "linuxboard/shim/devices/scenery.h"

#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace puckloop::linuxboard {

struct VideoControl {
    std::uint32_t id;
    std::uint32_t type;  ///< V4L2_CTRL_TYPE_...
    const char* name;
    std::int32_t minimum, maximum, step, initial;
};

class VideoControls {
  public:
    static constexpr std::size_t kCount = 7;

    VideoControls();
    /// errno value, 0 if none. Each changes the struct of its ioctl in place, as the kernel does.
    int query(std::string& data) const;           ///< VIDIOC_QUERYCTRL
    int query_extended(std::string& data) const;  ///< VIDIOC_QUERY_EXT_CTRL
    int get(std::string& data) const;             ///< VIDIOC_G_CTRL
    int set(std::string& data);                   ///< VIDIOC_S_CTRL; values out of range become the nearest
    /// VIDIOC_G_EXT_CTRLS, S and TRY: the struct is followed by what it points to.
    int get_several(std::string& data) const;
    int set_several(std::string& data, bool only_try);

    void apply(PictureSettings& settings) const;

  private:
    const VideoControl* find(std::uint32_t id) const;
    std::int32_t& value(const VideoControl& control);
    std::int32_t value(const VideoControl& control) const;

    std::array<std::int32_t, kCount> values_{};
};

}  // namespace puckloop::linuxboard
