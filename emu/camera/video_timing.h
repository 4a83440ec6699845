#pragma once
// A camera's lines as functions of time: nothing ticks. Time is in instruction cycles of the main board's
// chip, whose clock is the camera's master clock.
//
// The byte grid of a row: HREF rises in the middle of a byte, whose edge PCLK then rises with; every byte
// lasts one period of PCLK.

#include "emu/camera/video_mode.h"
#include "emu/chip/event_queue.h"

#include <cstdint>
#include <optional>

namespace puckloop::camera {

using chip::Cycle;
using chip::kNoCycle;

class VideoTiming {
  public:
    /// The first frame begins at cycle `start`.
    VideoTiming(const VideoMode& mode, Cycle start);

    /// Number of the frame at `now` (>= start).
    std::uint64_t frame(Cycle now) const { return thirds(now) / frame_; }
    bool vsync(Cycle now) const;
    bool href(Cycle now) const;
    bool pclk(Cycle now) const;

    /// The byte on the data lines, while HREF is high: of which pixel of the array, and which byte of it.
    struct Place {
        std::int32_t column = 0, row = 0;  ///< of the array; beyond it nothing is seen
        std::uint32_t byte = 0;
        std::uint32_t pixel = 0;  ///< number in its row, from HREF on
    };
    std::optional<Place> place(Cycle now) const;

    // The first cycle after `after` at which the line changes (the data: may change); kNoCycle: never.
    Cycle next_vsync(Cycle after) const;
    Cycle next_href(Cycle after) const;
    Cycle next_byte(Cycle after) const;  ///< PCLK and data

  private:
    std::uint64_t thirds(Cycle now) const { return 3 * (now - start_); }
    /// The first cycle at which `thirds` have passed.
    Cycle cycle_of(std::uint64_t thirds) const { return start_ + (thirds + 2) / 3; }
    bool row_comes_out(std::uint64_t row) const;
    std::uint64_t next_row(std::uint64_t row) const;

    VideoMode mode_;
    Cycle start_;
    std::uint64_t row_, frame_, byte_;    // lengths in thirds of a cycle
    std::uint64_t rise_, fall_;           // of HREF within a row
    std::uint64_t vsync_on_, vsync_off_;  // within a frame
};

}  // namespace puckloop::camera
