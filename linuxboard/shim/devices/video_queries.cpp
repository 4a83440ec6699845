// The ioctls that move no frame: what the camera is, its formats, sizes, rates, cropping and controls.

#include "linuxboard/shim/devices/ioctl_data.h"
#include "linuxboard/shim/devices/video_device.h"
#include "linuxboard/shim/devices/video_ioctl_names.h"

#include <fmt/format.h>

#include <linux/version.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iterator>

namespace puckloop::linuxboard {

namespace {

constexpr std::uint32_t kCapabilities =
    V4L2_CAP_VIDEO_CAPTURE | V4L2_CAP_STREAMING | V4L2_CAP_READWRITE | V4L2_CAP_EXT_PIX_FORMAT;
constexpr std::uint32_t kKernel = 5 << 16 | 10 << 8;  // the driver's version: that of its kernel

template <std::size_t Size>
void put_text(__u8 (&field)[Size], const std::string& text) {
    std::snprintf(reinterpret_cast<char*>(field), Size, "%s", text.c_str());
}

v4l2_rect whole_sensor() {
    return {0, 0, kSensorSize.width, kSensorSize.height};
}

int capability(const std::string& path, const std::string& card, std::string& data) {
    v4l2_capability capability{};
    put_text(capability.driver, "epuck-camera");
    put_text(capability.card, card);
    put_text(capability.bus_info, "platform:" + path.substr(path.rfind('/') + 1));
    capability.version = kKernel;
    capability.device_caps = kCapabilities;
    capability.capabilities = kCapabilities | V4L2_CAP_DEVICE_CAPS;
    put_struct(data, capability);
    return 0;
}

int enumerate_formats(std::string& data) {
    auto wanted = get_struct<v4l2_fmtdesc>(data);
    if (!is_capture(wanted.type) || wanted.index >= video_formats().size()) return EINVAL;
    const VideoFormat& format = video_formats()[wanted.index];
    v4l2_fmtdesc found{};
    found.index = wanted.index;
    found.type = wanted.type;
    found.pixelformat = format.fourcc;
    put_text(found.description, format.description);
    put_struct(data, found);
    return 0;
}

int enumerate_inputs(std::string& data) {
    auto input = get_struct<v4l2_input>(data);
    if (input.index != 0) return EINVAL;
    input = {};
    put_text(input.name, "Camera");
    input.type = V4L2_INPUT_TYPE_CAMERA;
    put_struct(data, input);
    return 0;
}

v4l2_pix_format picture_format(const VideoFormat& format, FrameSize size) {
    v4l2_pix_format picture{};
    picture.width = size.width;
    picture.height = size.height;
    picture.pixelformat = format.fourcc;
    picture.field = V4L2_FIELD_NONE;
    picture.bytesperline = size.width * format.bytes;
    picture.sizeimage = picture.bytesperline * size.height;
    picture.colorspace = V4L2_COLORSPACE_SRGB;
    picture.priv = V4L2_PIX_FMT_PRIV_MAGIC;
    picture.ycbcr_enc = V4L2_YCBCR_ENC_601;
    picture.quantization = V4L2_QUANTIZATION_FULL_RANGE;
    picture.xfer_func = V4L2_XFER_FUNC_SRGB;
    return picture;
}

}  // namespace

int VideoDevice::refuse(std::uint32_t request) {
    const char* name = video_ioctl_name(request);
    const std::string text = name != nullptr ? name : fmt::format("0x{:08x}", request);
    if (++refused_[text] == 1 && name == nullptr)
        unknown_.push_back(fmt::format("{}: ioctl {} is not known to V4L2: ENOTTY", path_, text));
    return ENOTTY;
}

std::uint32_t VideoDevice::highest_priority() const {
    std::uint32_t highest = V4L2_PRIORITY_UNSET;
    for (const auto& [handle, priority] : priorities_)
        highest = std::max(highest, priority);
    return highest;
}

int VideoDevice::set_priority(int handle, const std::string& data) {
    const auto priority = get_struct<std::uint32_t>(data);
    if (priority < V4L2_PRIORITY_BACKGROUND || priority > V4L2_PRIORITY_RECORD) return EINVAL;
    priorities_[handle] = priority;
    return 0;
}

std::optional<int> VideoDevice::query(int handle, std::uint32_t request, std::string& data) {
    switch (request) {
    case VIDIOC_QUERYCAP:
        return capability(path_, card_, data);
    case VIDIOC_ENUM_FMT:
        return enumerate_formats(data);
    case VIDIOC_ENUM_FRAMESIZES:
        return enumerate_sizes(data);
    case VIDIOC_ENUM_FRAMEINTERVALS:
        return enumerate_intervals(data);
    case VIDIOC_G_FMT:
        return get_format(data);
    case VIDIOC_S_FMT:
        return set_format(handle, data, false);
    case VIDIOC_TRY_FMT:
        return set_format(handle, data, true);
    case VIDIOC_G_PARM:
        return set_parameters(data, false);
    case VIDIOC_S_PARM:
        return set_parameters(data, true);
    case VIDIOC_ENUMINPUT:
        return enumerate_inputs(data);
    case VIDIOC_G_INPUT:
        put_struct(data, 0);
        return 0;
    case VIDIOC_S_INPUT:
        return get_struct<int>(data) == 0 ? 0 : EINVAL;
    case VIDIOC_G_PRIORITY:
        put_struct(data, highest_priority());
        return 0;
    case VIDIOC_S_PRIORITY:
        return set_priority(handle, data);
    case VIDIOC_CROPCAP:
    case VIDIOC_G_CROP:
    case VIDIOC_S_CROP:
        return crop(request, data);
    case VIDIOC_G_SELECTION:
        return selection(data, false);
    case VIDIOC_S_SELECTION:
        return selection(data, true);
    case VIDIOC_QUERYCTRL:
        return controls_.query(data);
    case VIDIOC_QUERY_EXT_CTRL:
        return controls_.query_extended(data);
    case VIDIOC_QUERYMENU:
        return EINVAL;  // no control is a menu
    case VIDIOC_G_CTRL:
        return controls_.get(data);
    case VIDIOC_S_CTRL:
        return controls_.set(data);
    case VIDIOC_G_EXT_CTRLS:
        return controls_.get_several(data);
    case VIDIOC_S_EXT_CTRLS:
        return controls_.set_several(data, false);
    case VIDIOC_TRY_EXT_CTRLS:
        return controls_.set_several(data, true);
    default:
        return refuse(request);
    }
}

int VideoDevice::get_format(std::string& data) const {
    auto format = get_struct<v4l2_format>(data);
    if (!is_capture(format.type)) return EINVAL;
    format.fmt.pix = picture_format(*format_, size_);
    put_struct(data, format);
    return 0;
}

int VideoDevice::set_format(int handle, std::string& data, bool only_try) {
    auto wanted = get_struct<v4l2_format>(data);
    if (!is_capture(wanted.type)) return EINVAL;
    if (!only_try && (busy_for(handle) || !buffers_.empty())) return EBUSY;
    const VideoFormat* format = find_format(wanted.fmt.pix.pixelformat);
    if (format == nullptr) format = &video_formats().front();
    const FrameSize size = nearest_size(wanted.fmt.pix.width, wanted.fmt.pix.height);
    if (!only_try) {
        format_ = format;
        size_ = size;
    }
    wanted.fmt.pix = picture_format(*format, size);
    put_struct(data, wanted);
    return 0;
}

int VideoDevice::enumerate_sizes(std::string& data) const {
    auto wanted = get_struct<v4l2_frmsizeenum>(data);
    if (find_format(wanted.pixel_format) == nullptr || wanted.index >= frame_sizes().size()) return EINVAL;
    v4l2_frmsizeenum found{};
    found.index = wanted.index;
    found.pixel_format = wanted.pixel_format;
    found.type = V4L2_FRMSIZE_TYPE_DISCRETE;
    found.discrete = {frame_sizes()[wanted.index].width, frame_sizes()[wanted.index].height};
    put_struct(data, found);
    return 0;
}

int VideoDevice::enumerate_intervals(std::string& data) const {
    auto wanted = get_struct<v4l2_frmivalenum>(data);
    const bool has_size = std::any_of(frame_sizes().begin(), frame_sizes().end(), [&](const FrameSize& size) {
        return size.width == wanted.width && size.height == wanted.height;
    });
    if (find_format(wanted.pixel_format) == nullptr || !has_size || wanted.index >= std::size(kFrameRates))
        return EINVAL;
    v4l2_frmivalenum found{};
    found.index = wanted.index;
    found.pixel_format = wanted.pixel_format;
    found.width = wanted.width;
    found.height = wanted.height;
    found.type = V4L2_FRMIVAL_TYPE_DISCRETE;
    found.discrete = {1, kFrameRates[wanted.index]};
    put_struct(data, found);
    return 0;
}

int VideoDevice::set_parameters(std::string& data, bool set) {
    auto wanted = get_struct<v4l2_streamparm>(data);
    if (!is_capture(wanted.type)) return EINVAL;
    if (set) {
        if (streaming_) return EBUSY;
        rate_ = nearest_rate(wanted.parm.capture.timeperframe.numerator,
                             wanted.parm.capture.timeperframe.denominator);
    }
    v4l2_streamparm found{};
    found.type = wanted.type;
    found.parm.capture.capability = V4L2_CAP_TIMEPERFRAME;
    found.parm.capture.timeperframe = {1, rate_};
    found.parm.capture.readbuffers = kReadBuffers;
    put_struct(data, found);
    return 0;
}

int VideoDevice::crop(std::uint32_t request, std::string& data) const {
    if (request == VIDIOC_CROPCAP) {
        auto capability = get_struct<v4l2_cropcap>(data);
        if (!is_capture(capability.type)) return EINVAL;
        capability.bounds = capability.defrect = whole_sensor();
        capability.pixelaspect = {1, 1};
        put_struct(data, capability);
        return 0;
    }
    auto crop = get_struct<v4l2_crop>(data);
    if (!is_capture(crop.type)) return EINVAL;
    if (request == VIDIOC_S_CROP) return 0;  // the nearest that there is: all of the sensor
    crop.c = whole_sensor();
    put_struct(data, crop);
    return 0;
}

int VideoDevice::selection(std::string& data, bool set) const {
    auto wanted = get_struct<v4l2_selection>(data);
    if (!is_capture(wanted.type)) return EINVAL;
    switch (wanted.target) {
    case V4L2_SEL_TGT_CROP:
        break;
    case V4L2_SEL_TGT_CROP_DEFAULT:
    case V4L2_SEL_TGT_CROP_BOUNDS:
        if (set) return EINVAL;
        break;
    default:
        return EINVAL;
    }
    v4l2_selection found{};
    found.type = wanted.type;
    found.target = wanted.target;
    found.r = whole_sensor();
    put_struct(data, found);
    return 0;
}

}  // namespace puckloop::linuxboard
