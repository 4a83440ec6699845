#include "linuxboard/shim/devices/video_controls.h"

#include "linuxboard/shim/devices/ioctl_data.h"

#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::linuxboard {

namespace {

constexpr std::array<VideoControl, VideoControls::kCount> kControls{{
    // In the order of their numbers, as programs go through them.
    {V4L2_CID_USER_CLASS, V4L2_CTRL_TYPE_CTRL_CLASS, "User Controls", 0, 0, 0, 0},
    {V4L2_CID_BRIGHTNESS, V4L2_CTRL_TYPE_INTEGER, "Brightness", -100, 100, 1, 0},
    {V4L2_CID_CONTRAST, V4L2_CTRL_TYPE_INTEGER, "Contrast", 0, 200, 1, 100},
    {V4L2_CID_SATURATION, V4L2_CTRL_TYPE_INTEGER, "Saturation", 0, 200, 1, 100},
    {V4L2_CID_GAIN, V4L2_CTRL_TYPE_INTEGER, "Gain", 0, 63, 1, 26},
    {V4L2_CID_HFLIP, V4L2_CTRL_TYPE_BOOLEAN, "Horizontal Flip", 0, 1, 1, 0},
    {V4L2_CID_VFLIP, V4L2_CTRL_TYPE_BOOLEAN, "Vertical Flip", 0, 1, 1, 0},
}};
constexpr std::uint32_t kNextFlags = V4L2_CTRL_FLAG_NEXT_CTRL | V4L2_CTRL_FLAG_NEXT_COMPOUND;
constexpr std::uint32_t kClassFlags = V4L2_CTRL_FLAG_READ_ONLY | V4L2_CTRL_FLAG_WRITE_ONLY;

bool is_class(const VideoControl& control) {
    return control.type == V4L2_CTRL_TYPE_CTRL_CLASS;
}

/// The control asked for, or the next one, if there is such a one.
const VideoControl* asked(std::uint32_t id) {
    const bool next = (id & V4L2_CTRL_FLAG_NEXT_CTRL) != 0;
    if ((id & kNextFlags) != 0 && !next) return nullptr;  // no compound controls
    const std::uint32_t number = id & ~kNextFlags;
    const auto found = std::find_if(kControls.begin(), kControls.end(), [&](const VideoControl& control) {
        return next ? control.id > number : control.id == number;
    });
    return found == kControls.end() ? nullptr : &*found;
}

template <typename Query>
void describe(const VideoControl& control, Query& query) {
    query = {};
    query.id = control.id;
    query.type = control.type;
    query.minimum = control.minimum;
    query.maximum = control.maximum;
    query.step = static_cast<decltype(query.step)>(control.step);
    query.default_value = control.initial;
    if (is_class(control)) query.flags = kClassFlags;
    std::strncpy(reinterpret_cast<char*>(query.name), control.name, sizeof query.name - 1);
}

/// The controls that follow the struct of an ioctl on several.
std::size_t listed(const std::string& data) {
    const auto head = get_struct<v4l2_ext_controls>(data);
    const std::size_t room = (data.size() - std::min(data.size(), sizeof head)) / sizeof(v4l2_ext_control);
    return std::min<std::size_t>(head.count, room);
}
std::size_t place_of(std::size_t index) {
    return sizeof(v4l2_ext_controls) + index * sizeof(v4l2_ext_control);
}
void fail_at(std::string& data, std::size_t index) {
    auto head = get_struct<v4l2_ext_controls>(data);
    head.error_idx = static_cast<std::uint32_t>(index);
    put_struct(data, head);
}

}  // namespace

VideoControls::VideoControls() {
    for (const VideoControl& control : kControls)
        value(control) = control.initial;
}

const VideoControl* VideoControls::find(std::uint32_t id) const {
    const VideoControl* control = (id & kNextFlags) != 0 ? nullptr : asked(id);
    return control == nullptr || is_class(*control) ? nullptr : control;
}
std::int32_t& VideoControls::value(const VideoControl& control) {
    return values_[static_cast<std::size_t>(&control - kControls.data())];
}
std::int32_t VideoControls::value(const VideoControl& control) const {
    return values_[static_cast<std::size_t>(&control - kControls.data())];
}

int VideoControls::query(std::string& data) const {
    auto query = get_struct<v4l2_queryctrl>(data);
    const VideoControl* control = asked(query.id);
    if (control == nullptr) return EINVAL;
    describe(*control, query);
    put_struct(data, query);
    return 0;
}

int VideoControls::query_extended(std::string& data) const {
    auto query = get_struct<v4l2_query_ext_ctrl>(data);
    const VideoControl* control = asked(query.id);
    if (control == nullptr) return EINVAL;
    describe(*control, query);
    query.elem_size = sizeof(std::int32_t);
    query.elems = 1;
    put_struct(data, query);
    return 0;
}

int VideoControls::get(std::string& data) const {
    auto one = get_struct<v4l2_control>(data);
    const VideoControl* control = find(one.id);
    if (control == nullptr) return asked(one.id) != nullptr ? EACCES : EINVAL;
    one.value = value(*control);
    put_struct(data, one);
    return 0;
}

int VideoControls::set(std::string& data) {
    auto one = get_struct<v4l2_control>(data);
    const VideoControl* control = find(one.id);
    if (control == nullptr) return asked(one.id) != nullptr ? EACCES : EINVAL;
    one.value = std::clamp(one.value, control->minimum, control->maximum);
    value(*control) = one.value;
    put_struct(data, one);
    return 0;
}

int VideoControls::get_several(std::string& data) const {
    const auto head = get_struct<v4l2_ext_controls>(data);
    const bool initial = head.which == V4L2_CTRL_WHICH_DEF_VAL;
    const std::size_t count = listed(data);
    if (count < head.count || head.which == V4L2_CTRL_WHICH_REQUEST_VAL) return EINVAL;
    for (std::size_t i = 0; i < count; ++i) {
        auto one = get_struct<v4l2_ext_control>(data, place_of(i));
        const VideoControl* control = find(one.id);
        if (control == nullptr) {
            fail_at(data, count);  // as the kernel: nothing was read
            return asked(one.id) != nullptr ? EACCES : EINVAL;
        }
        one.value = initial ? control->initial : value(*control);
        put_struct(data, one, place_of(i));
    }
    return 0;
}

int VideoControls::set_several(std::string& data, bool only_try) {
    const auto head = get_struct<v4l2_ext_controls>(data);
    const std::size_t count = listed(data);
    if (count < head.count || head.which == V4L2_CTRL_WHICH_DEF_VAL ||
        head.which == V4L2_CTRL_WHICH_REQUEST_VAL)
        return EINVAL;
    for (std::size_t i = 0; i < count; ++i) {
        const auto one = get_struct<v4l2_ext_control>(data, place_of(i));
        if (find(one.id) != nullptr) continue;
        fail_at(data, only_try ? i : count);
        return asked(one.id) != nullptr ? EACCES : EINVAL;
    }
    for (std::size_t i = 0; i < count; ++i) {
        auto one = get_struct<v4l2_ext_control>(data, place_of(i));
        const VideoControl& control = *find(one.id);
        one.value = std::clamp(one.value, control.minimum, control.maximum);
        if (!only_try) value(control) = one.value;
        put_struct(data, one, place_of(i));
    }
    return 0;
}

void VideoControls::apply(PictureSettings& settings) const {
    const auto now = [this](std::uint32_t id) { return value(*find(id)); };
    settings.gain = now(V4L2_CID_GAIN);
    settings.brightness = now(V4L2_CID_BRIGHTNESS);
    settings.contrast = now(V4L2_CID_CONTRAST);
    settings.saturation = now(V4L2_CID_SATURATION);
    settings.mirror = now(V4L2_CID_HFLIP) != 0;
    settings.flip = now(V4L2_CID_VFLIP) != 0;
}

}  // namespace puckloop::linuxboard
