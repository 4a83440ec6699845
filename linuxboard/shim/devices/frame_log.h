#pragma once
// What a camera's frames were: a line each in a CSV file, a hash over all of them, and, where asked for, the
// pictures themselves as PPM files.

#include "cosim/core/time.h"
#include "linuxboard/shim/devices/video_formats.h"

#include <cstdint>
#include <fstream>
#include <span>
#include <string>

namespace puckloop::linuxboard {

class FrameLog {
  public:
    /// `csv`: file, empty: none; `folder`: of the pictures, made when the first is written, empty: none;
    /// every `every`-th frame is kept. Throws InputError if the file cannot be written.
    FrameLog(const std::string& csv, std::string folder, std::uint32_t every);

    struct Frame {
        cosim::Time instant = 0;
        std::uint64_t number = 0;    ///< of the sensor
        std::uint32_t sequence = 0;  ///< of the stream
        FrameSize size{};
        const VideoFormat* format = nullptr;
    };
    /// `bytes` as the program gets them, `rgb` the same picture. Throws RunError if a picture cannot be
    /// written.
    void add(const Frame& frame, std::span<const std::uint8_t> bytes, std::span<const std::uint8_t> rgb);

    std::uint64_t frames() const { return frames_; }
    /// Of the hashes of all frames, in order.
    std::uint64_t hash() const { return hash_; }

  private:
    void save(const Frame& frame, std::span<const std::uint8_t> rgb) const;

    std::ofstream csv_;
    std::string folder_;
    std::uint32_t every_;
    std::uint64_t frames_ = 0;
    std::uint64_t hash_ = 0;
};

}  // namespace puckloop::linuxboard
