#pragma once
// A camera as its driver shows it: a V4L2 capture device whose sensor runs freely at its frame rate.
//
// At the beginning of each frame the next buffer of the queue is taken and the picture of that instant put
// into it; one frame period later (read-out) it is done and can be taken out. A frame that finds no buffer is
// lost, its number missing among the sequence numbers. Time stamps are CLOCK_MONOTONIC at the end of the
// frame. Buffers lie in memory that the program maps; read() uses the first three of them, so that it
// delivers every frame to a program that keeps up.
//
// Deviations: 1. All of a picture is of one instant (no rolling shutter). 2. Only one format at a time, and
// only MMAP buffers, no dma-buf (EXPBUF), no events. 3. Buffers given back by VIDIOC_REQBUFS while they are
// mapped are used again for the next ones.

#include "cosim/core/time.h"
#include "linuxboard/shim/devices/frame_log.h"
#include "linuxboard/shim/devices/scenery.h"
#include "linuxboard/shim/devices/video_controls.h"
#include "linuxboard/shim/devices/video_formats.h"

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

struct v4l2_buffer;

namespace puckloop::linuxboard {

struct CameraSpec;

/// Buffers of read(): one is filled, one waits for the next frame, one is being read.
inline constexpr std::uint32_t kReadBuffers = 3;

/// Whether a buffer's or a format's `type` is that of frames taken, the only ones here.
bool is_capture(std::uint32_t type);

class VideoDevice {
  public:
    /// `number` of the camera among the board's; `memory`: its part of the shared memory, wire::kVideoSize
    /// bytes; `uptime`: CLOCK_MONOTONIC at time 0, `clock_error` its error (wire/board_clock.h). Throws
    /// InputError if its log cannot be written.
    VideoDevice(const CameraSpec& spec, std::size_t number, cosim::Time uptime, Scenery& scenery,
                char* memory, std::int64_t clock_error = 0);

    /// There is an open file `handle`.
    void open(int handle) { priorities_[handle] = kUsualPriority; }
    /// It is gone.
    void close(int handle);
    /// One ioctl; its struct, and what that points to, is changed in place. The errno value, 0 if none;
    /// nothing if it has to wait for a frame.
    std::optional<int> ioctl(int handle, std::uint32_t request, std::string& data, bool nonblocking,
                             cosim::Time now);
    /// Where in `memory` a mapping of `length` bytes at `offset` lies; nothing: EINVAL.
    std::optional<std::uint64_t> map(std::uint32_t offset, std::uint32_t length);
    /// What a read() gives: bytes at a place in `memory`, or an errno value. Nothing: it has to wait.
    struct ReadResult {
        int error = 0;
        std::uint64_t place = 0;
        std::uint32_t bytes = 0;
    };
    std::optional<ReadResult> read(int handle, std::uint32_t most, bool nonblocking, cosim::Time now);
    /// As poll(); with `wants_input` a device that nobody streams from begins to read.
    std::int16_t events(int handle, bool wants_input, cosim::Time now);

    /// Handles the frame that begins at `now`, if one does.
    void advance(cosim::Time now);
    /// When the next frame begins; never while nothing streams.
    cosim::Time next_event() const { return streaming_ ? frame_start(next_frame_) : cosim::kNever; }

    /// The camera's part of the report, as JSON.
    std::string report() const;
    const std::string& path() const { return path_; }
    /// What was asked that the driver does not know, for the run's warnings: once each.
    std::vector<std::string> take_unknown();

  private:
    struct Buffer {
        enum class State { Dequeued, Queued, Filling, Done };
        State state = State::Dequeued;
        bool mapped = false;
        std::uint32_t sequence = 0;
        cosim::Time done = 0;
    };

    // video_device.cpp: buffers and frames
    std::uint32_t frame_bytes() const { return size_.width * size_.height * format_->bytes; }
    cosim::Time frame_start(std::uint64_t frame) const;
    std::span<std::uint8_t> memory_of(std::size_t index) const;
    int request_buffers(int handle, std::string& data);
    int query_buffer(std::string& data) const;
    int queue_buffer(int handle, std::string& data);
    std::optional<int> dequeue_buffer(int handle, std::string& data, bool nonblocking);
    void describe(std::size_t index, v4l2_buffer& buffer) const;
    int stream_on(int handle, const std::string& data, cosim::Time now);
    int stream_off(int handle, const std::string& data);
    void start(cosim::Time now);
    void stop();
    void free_buffers();
    bool busy_for(int handle) const { return owner_ >= 0 && owner_ != handle; }
    void begin_reading(int handle, cosim::Time now);
    void fill(std::size_t index, cosim::Time instant);

    // video_queries.cpp: what does not move a frame
    std::optional<int> query(int handle, std::uint32_t request, std::string& data);
    int refuse(std::uint32_t request);
    std::uint32_t highest_priority() const;
    int set_priority(int handle, const std::string& data);
    int set_format(int handle, std::string& data, bool only_try);
    int get_format(std::string& data) const;
    int enumerate_sizes(std::string& data) const;
    int enumerate_intervals(std::string& data) const;
    int set_parameters(std::string& data, bool set);
    int selection(std::string& data, bool set) const;
    int crop(std::uint32_t request, std::string& data) const;

    std::string path_;
    std::string card_;
    std::size_t number_;
    cosim::Time uptime_;
    std::int64_t clock_error_;
    Scenery& scenery_;
    char* memory_;

    const VideoFormat* format_ = &video_formats().front();
    FrameSize size_ = kSensorSize;
    std::uint32_t rate_ = kFrameRates[0];
    VideoControls controls_;
    static constexpr std::uint32_t kUsualPriority = 2;  ///< V4L2_PRIORITY_INTERACTIVE
    std::map<int, std::uint32_t> priorities_;           // by open file

    int owner_ = -1;  // open file that has the buffers
    bool reading_ = false;
    bool none_queued_yet_ = true;  ///< since there are buffers, or since the last stream's end
    std::uint32_t read_from_ = 0;  // of the frame that a read() has begun with
    std::vector<Buffer> buffers_;
    std::deque<std::size_t> queued_, done_;
    std::optional<std::size_t> filling_;
    bool streaming_ = false;
    std::uint64_t next_frame_ = 0;   // of the sensor, counted from time 0 at the present rate
    std::uint64_t first_frame_ = 0;  // of this streaming

    std::vector<std::uint8_t> rgb_;  // scratch
    FrameLog log_;
    std::uint64_t lost_ = 0;
    std::map<std::string, std::uint64_t> refused_;  // ioctls, by name
    std::vector<std::string> unknown_;
};

}  // namespace puckloop::linuxboard
