#include "linuxboard/control/devices/video_camera.h"

#include <fcntl.h>
#include <linux/videodev2.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <stdexcept>

namespace puckloop::control {

namespace {

constexpr unsigned kBuffers = 3;  // one is read, one filled, one waits

int call(int descriptor, unsigned long request, void* argument) {
    int result = -1;
    do {
        result = ::ioctl(descriptor, request, argument);
    } while (result < 0 && errno == EINTR);
    return result;
}

v4l2_buffer buffer_number(unsigned index) {
    v4l2_buffer buffer{};
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.index = index;
    return buffer;
}

}  // namespace

void VideoCamera::fail(const char* what) const {
    throw std::runtime_error(device_ + ": " + what + ": " + std::strerror(errno));
}

VideoCamera::VideoCamera(const std::string& device, std::size_t width, std::size_t height)
    : device_(device), width_(width), height_(height) {
    descriptor_ = ::open(device.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) fail("cannot be opened");
    try {
        start();
    } catch (...) {
        ::close(descriptor_);
        throw;
    }
}

void VideoCamera::start() {
    v4l2_format format{};
    format.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    format.fmt.pix.width = static_cast<unsigned>(width_);
    format.fmt.pix.height = static_cast<unsigned>(height_);
    format.fmt.pix.pixelformat = V4L2_PIX_FMT_YUYV;
    format.fmt.pix.field = V4L2_FIELD_NONE;
    if (call(descriptor_, VIDIOC_S_FMT, &format) < 0) fail("VIDIOC_S_FMT");
    errno = EINVAL;
    if (format.fmt.pix.pixelformat != V4L2_PIX_FMT_YUYV) fail("gives no YUYV");
    width_ = format.fmt.pix.width;
    height_ = format.fmt.pix.height;
    if (format.fmt.pix.bytesperline != width_ * 2) fail("pads its lines");

    v4l2_requestbuffers request{};
    request.count = kBuffers;
    request.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    request.memory = V4L2_MEMORY_MMAP;
    if (call(descriptor_, VIDIOC_REQBUFS, &request) < 0) fail("VIDIOC_REQBUFS");
    for (unsigned i = 0; i < request.count; ++i) {
        v4l2_buffer buffer = buffer_number(i);
        if (call(descriptor_, VIDIOC_QUERYBUF, &buffer) < 0) fail("VIDIOC_QUERYBUF");
        void* data = ::mmap(nullptr, buffer.length, PROT_READ, MAP_SHARED, descriptor_, buffer.m.offset);
        if (data == MAP_FAILED) fail("mmap");
        buffers_.push_back({data, buffer.length});
        give_back(i);
    }
    v4l2_buf_type type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    if (call(descriptor_, VIDIOC_STREAMON, &type) < 0) fail("VIDIOC_STREAMON");
}

VideoCamera::~VideoCamera() {
    v4l2_buf_type type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    call(descriptor_, VIDIOC_STREAMOFF, &type);
    for (const Buffer& buffer : buffers_)
        ::munmap(buffer.data, buffer.size);
    ::close(descriptor_);
}

void VideoCamera::give_back(unsigned index) {
    v4l2_buffer buffer = buffer_number(index);
    if (call(descriptor_, VIDIOC_QBUF, &buffer) < 0) fail("VIDIOC_QBUF");
}

std::span<const std::uint8_t> VideoCamera::newest() {
    while (true) {
        v4l2_buffer buffer = buffer_number(0);
        if (call(descriptor_, VIDIOC_DQBUF, &buffer) < 0) {
            if (errno != EAGAIN) fail("VIDIOC_DQBUF");
            break;
        }
        if (held_ >= 0) give_back(static_cast<unsigned>(held_));
        held_ = static_cast<int>(buffer.index);
        ++frames_;
        if (last_sequence_ >= 0) unused_ += static_cast<unsigned long>(buffer.sequence - last_sequence_ - 1);
        last_sequence_ = buffer.sequence;
    }
    if (held_ < 0) return {};
    return {static_cast<const std::uint8_t*>(buffers_[static_cast<std::size_t>(held_)].data),
            width_ * height_ * 2};
}

}  // namespace puckloop::control
