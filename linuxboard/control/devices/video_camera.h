#pragma once
// A V4L2 camera: streams YUYV frames into mapped buffers; whoever asks gets the newest one.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace puckloop::control {

class VideoCamera {
  public:
    /// Opens `device` and starts it, as near to `width` x `height` as it can. Throws std::runtime_error
    /// naming the device and what failed.
    VideoCamera(const std::string& device, std::size_t width, std::size_t height);
    ~VideoCamera();
    VideoCamera(const VideoCamera&) = delete;
    VideoCamera& operator=(const VideoCamera&) = delete;

    /// The newest complete frame, valid until the next call; the one before where none has come since, and
    /// empty before the first. Older ones are given back unseen. Throws std::runtime_error.
    std::span<const std::uint8_t> newest();
    std::size_t width() const { return width_; }
    std::size_t height() const { return height_; }
    /// Frames taken, and those that came while both buffers were full, so far.
    unsigned long frames() const { return frames_; }
    unsigned long unused() const { return unused_; }

  private:
    struct Buffer {
        void* data = nullptr;
        std::size_t size = 0;
    };
    void start();
    void give_back(unsigned index);
    [[noreturn]] void fail(const char* what) const;

    std::string device_;
    int descriptor_ = -1;
    std::size_t width_, height_;
    std::vector<Buffer> buffers_;
    int held_ = -1;  // buffer of the newest frame
    unsigned long frames_ = 0, unused_ = 0;
    long last_sequence_ = -1;
};

}  // namespace puckloop::control
