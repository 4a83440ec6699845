#include "linuxboard/shim/devices/video_device.h"

#include "base/json.h"
#include "linuxboard/shim/devices/camera_spec.h"
#include "linuxboard/shim/devices/ioctl_data.h"
#include "linuxboard/shim/wire/board_clock.h"
#include "linuxboard/shim/wire/wire.h"

#include <fmt/format.h>

#include <linux/videodev2.h>
#include <poll.h>

#include <algorithm>
#include <cerrno>

namespace puckloop::linuxboard {

using cosim::kSecond;
using cosim::Time;

namespace {
constexpr std::size_t kRgbBytes = 3;

/// Not for an open file of lower priority than another one's.
bool changes_device(std::uint32_t request) {
    switch (request) {
    case VIDIOC_S_FMT:
    case VIDIOC_S_PARM:
    case VIDIOC_S_INPUT:
    case VIDIOC_S_CTRL:
    case VIDIOC_S_EXT_CTRLS:
    case VIDIOC_S_CROP:
    case VIDIOC_S_SELECTION:
    case VIDIOC_S_PRIORITY:
    case VIDIOC_REQBUFS:
    case VIDIOC_STREAMON:
    case VIDIOC_STREAMOFF:
        return true;
    default:
        return false;
    }
}
}  // namespace

bool is_capture(std::uint32_t type) {
    return type == V4L2_BUF_TYPE_VIDEO_CAPTURE;
}

VideoDevice::VideoDevice(const CameraSpec& spec, std::size_t number, Time uptime, Scenery& scenery,
                         char* memory, std::int64_t clock_error)
    : path_(spec.device),
      card_(spec.card),
      number_(number),
      uptime_(uptime),
      clock_error_(clock_error),
      scenery_(scenery),
      memory_(memory),
      log_(spec.log, spec.save, spec.save_every) {}

Time VideoDevice::frame_start(std::uint64_t frame) const {
    return static_cast<Time>(frame / rate_) * kSecond +
           static_cast<Time>(frame % rate_) * kSecond / static_cast<Time>(rate_);
}

std::span<std::uint8_t> VideoDevice::memory_of(std::size_t index) const {
    return {reinterpret_cast<std::uint8_t*>(memory_) + index * wire::kVideoBufferSize, frame_bytes()};
}

std::optional<int> VideoDevice::ioctl(int handle, std::uint32_t request, std::string& data, bool nonblocking,
                                      Time now) {
    if (changes_device(request) && priorities_[handle] < highest_priority()) return EBUSY;
    switch (request) {
    case VIDIOC_REQBUFS:
        return request_buffers(handle, data);
    case VIDIOC_QUERYBUF:
        return query_buffer(data);
    case VIDIOC_QBUF:
        return queue_buffer(handle, data);
    case VIDIOC_DQBUF:
        return dequeue_buffer(handle, data, nonblocking);
    case VIDIOC_STREAMON:
        return stream_on(handle, data, now);
    case VIDIOC_STREAMOFF:
        return stream_off(handle, data);
    default:
        return query(handle, request, data);
    }
}

int VideoDevice::request_buffers(int handle, std::string& data) {
    auto wanted = get_struct<v4l2_requestbuffers>(data);
    if (!is_capture(wanted.type) || wanted.memory != V4L2_MEMORY_MMAP) return EINVAL;
    if (busy_for(handle) || reading_ || streaming_) return EBUSY;
    free_buffers();
    wanted.count = std::min(wanted.count, wire::kMostVideoBuffers);
    const std::uint32_t count = wanted.count;
    wanted = {};
    wanted.count = count;
    wanted.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    wanted.memory = V4L2_MEMORY_MMAP;
    wanted.capabilities = V4L2_BUF_CAP_SUPPORTS_MMAP;
    buffers_.assign(wanted.count, {});
    owner_ = wanted.count > 0 ? handle : -1;
    put_struct(data, wanted);
    return 0;
}

void VideoDevice::describe(std::size_t index, v4l2_buffer& buffer) const {
    const Buffer& own = buffers_[index];
    buffer = {};
    buffer.index = static_cast<std::uint32_t>(index);
    buffer.type = V4L2_BUF_TYPE_VIDEO_CAPTURE;
    buffer.memory = V4L2_MEMORY_MMAP;
    buffer.field = V4L2_FIELD_NONE;
    buffer.length = frame_bytes();
    buffer.m.offset = buffer.index * wire::kVideoBufferSize;
    buffer.flags = V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
    if (own.mapped) buffer.flags |= V4L2_BUF_FLAG_MAPPED;
    if (own.state == Buffer::State::Queued || own.state == Buffer::State::Filling)
        buffer.flags |= V4L2_BUF_FLAG_QUEUED;
    if (own.state == Buffer::State::Done) buffer.flags |= V4L2_BUF_FLAG_DONE;
    if (own.done == 0) return;  // never filled
    const Time stamp = uptime_ + wire::board_time(own.done, clock_error_);
    buffer.bytesused = frame_bytes();
    buffer.sequence = own.sequence;
    buffer.timestamp.tv_sec = stamp / kSecond;
    buffer.timestamp.tv_usec = stamp % kSecond / cosim::kMicrosecond;
}

int VideoDevice::query_buffer(std::string& data) const {
    auto buffer = get_struct<v4l2_buffer>(data);
    if (!is_capture(buffer.type) || reading_ || buffer.index >= buffers_.size()) return EINVAL;
    describe(buffer.index, buffer);
    put_struct(data, buffer);
    return 0;
}

int VideoDevice::queue_buffer(int handle, std::string& data) {
    auto buffer = get_struct<v4l2_buffer>(data);
    if (!is_capture(buffer.type)) return EINVAL;
    if (busy_for(handle) || reading_) return EBUSY;
    if (buffer.memory != V4L2_MEMORY_MMAP || buffer.index >= buffers_.size()) return EINVAL;
    if ((buffer.flags & V4L2_BUF_FLAG_REQUEST_FD) != 0) return EBADR;  // as drivers without requests
    Buffer& own = buffers_[buffer.index];
    if (own.state != Buffer::State::Dequeued) return EINVAL;
    own.state = Buffer::State::Queued;
    none_queued_yet_ = false;
    queued_.push_back(buffer.index);
    describe(buffer.index, buffer);
    put_struct(data, buffer);
    return 0;
}

std::optional<int> VideoDevice::dequeue_buffer(int handle, std::string& data, bool nonblocking) {
    auto buffer = get_struct<v4l2_buffer>(data);
    if (!is_capture(buffer.type)) return EINVAL;
    if (busy_for(handle) || reading_) return EBUSY;
    if (!streaming_) return EINVAL;
    if (done_.empty()) return nonblocking ? std::optional<int>(EAGAIN) : std::nullopt;
    const std::size_t index = done_.front();
    done_.pop_front();
    buffers_[index].state = Buffer::State::Dequeued;
    describe(index, buffer);
    put_struct(data, buffer);
    return 0;
}

int VideoDevice::stream_on(int handle, const std::string& data, Time now) {
    if (!is_capture(get_struct<std::uint32_t>(data))) return EINVAL;
    if (busy_for(handle) || reading_) return EBUSY;
    if (buffers_.empty()) return EINVAL;
    start(now);
    return 0;
}

int VideoDevice::stream_off(int handle, const std::string& data) {
    if (!is_capture(get_struct<std::uint32_t>(data))) return EINVAL;
    if (busy_for(handle) || reading_) return EBUSY;
    stop();
    return 0;
}

void VideoDevice::start(Time now) {
    if (streaming_) return;
    streaming_ = true;
    next_frame_ = static_cast<std::uint64_t>(now / kSecond) * rate_;
    while (frame_start(next_frame_) <= now)
        ++next_frame_;
    first_frame_ = next_frame_;
}

void VideoDevice::stop() {
    streaming_ = false;
    none_queued_yet_ = true;
    filling_.reset();
    queued_.clear();
    done_.clear();
    for (Buffer& buffer : buffers_) {
        buffer.state = Buffer::State::Dequeued;
        buffer.done = 0;
    }
}

void VideoDevice::free_buffers() {
    stop();
    buffers_.clear();
    owner_ = -1;
    reading_ = false;
}

void VideoDevice::close(int handle) {
    priorities_.erase(handle);
    if (owner_ == handle) free_buffers();
}

std::optional<std::uint64_t> VideoDevice::map(std::uint32_t offset, std::uint32_t length) {
    const std::size_t index = offset / wire::kVideoBufferSize;
    constexpr std::uint32_t kPage = 4096;
    if (offset % wire::kVideoBufferSize != 0 || index >= buffers_.size() || reading_) return std::nullopt;
    if (length > (frame_bytes() + kPage - 1) / kPage * kPage) return std::nullopt;
    buffers_[index].mapped = true;
    return offset;
}

void VideoDevice::begin_reading(int handle, Time now) {
    owner_ = handle;
    reading_ = true;
    buffers_.assign(kReadBuffers, {});
    for (std::size_t index = 0; index < buffers_.size(); ++index) {
        buffers_[index].state = Buffer::State::Queued;
        queued_.push_back(index);
    }
    read_from_ = 0;
    start(now);
}

std::optional<VideoDevice::ReadResult> VideoDevice::read(int handle, std::uint32_t most, bool nonblocking,
                                                         Time now) {
    if (busy_for(handle) || (owner_ == handle && !reading_)) return ReadResult{EBUSY};
    if (!reading_) begin_reading(handle, now);
    if (done_.empty()) return nonblocking ? std::optional(ReadResult{EAGAIN}) : std::nullopt;
    ReadResult result;
    const std::size_t index = done_.front();
    result.place = index * wire::kVideoBufferSize + read_from_;
    result.bytes = std::min(most, frame_bytes() - read_from_);
    read_from_ += result.bytes;
    if (read_from_ == frame_bytes()) {  // the next read() is of the next frame
        read_from_ = 0;
        done_.pop_front();
        buffers_[index].state = Buffer::State::Queued;
        queued_.push_back(index);
    }
    return result;
}

std::int16_t VideoDevice::events(int handle, bool wants_input, Time now) {
    if (owner_ < 0 && wants_input) begin_reading(handle, now);
    if (!streaming_ || busy_for(handle)) return POLLERR;
    // As videobuf2, for programs of the time before it: nothing will come.
    if (none_queued_yet_ && !reading_ && wants_input) return POLLERR;
    return done_.empty() ? 0 : POLLIN | POLLRDNORM;
}

void VideoDevice::fill(std::size_t index, Time instant) {
    Buffer& buffer = buffers_[index];
    buffer.state = Buffer::State::Filling;
    buffer.sequence = static_cast<std::uint32_t>(next_frame_ - first_frame_);
    PictureSettings settings;
    settings.width = size_.width;
    settings.height = size_.height;
    controls_.apply(settings);
    rgb_.resize(std::size_t{size_.width} * size_.height * kRgbBytes);
    scenery_.render(number_, settings, instant, next_frame_, rgb_);
    convert(*format_, rgb_, memory_of(index));
    log_.add({instant, next_frame_, buffer.sequence, size_, format_}, memory_of(index), rgb_);
}

void VideoDevice::advance(Time now) {
    if (!streaming_ || frame_start(next_frame_) != now) return;
    if (filling_) {
        buffers_[*filling_].state = Buffer::State::Done;
        buffers_[*filling_].done = now;
        done_.push_back(*filling_);
        filling_.reset();
    }
    if (queued_.empty()) {
        // A read() that nobody waits for loses no frame: the sensor's go by.
        if (!reading_) ++lost_;
    } else {
        filling_ = queued_.front();
        queued_.pop_front();
        fill(*filling_, now);
    }
    ++next_frame_;
}

std::string VideoDevice::report() const {
    nlohmann::ordered_json report{{"device", path_},
                                  {"frames", log_.frames()},
                                  {"lost", lost_},
                                  {"hash", fmt::format("{:016x}", log_.hash())},
                                  {"refused_ioctls", refused_}};
    return report.dump();
}

std::vector<std::string> VideoDevice::take_unknown() {
    return std::exchange(unknown_, {});
}

}  // namespace puckloop::linuxboard
