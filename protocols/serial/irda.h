#pragma once
// IrDA's coding of a serial line (SIR): the decoder of a UART. Encoded frames are is_infrared().

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace puckloop::protocols {

/// Of a frame in this coding, in place of a glitch's: a low bit is a low pulse from the 7th to the 10th
/// sixteenth of its time, else the line is high.
inline constexpr std::uint32_t kInfraredWidth = std::numeric_limits<std::uint32_t>::max();
constexpr bool is_infrared(const cosim::UartFrame& frame) {
    return frame.glitch_width == kInfraredWidth;
}
constexpr void set_infrared(cosim::UartFrame& frame) {
    frame.glitch_at = 0;
    frame.glitch_width = kInfraredWidth;
}

/// Makes of each falling edge of the line a low level of one bit time, counted by the receiver's own clock.
///
/// Deviation: an edge within the low level that the one before it made begins the next one at its end, so
/// that clocks that differ leave no gap.
class IrdaDecoder {
  public:
    /// What `frame`, high at rest, is behind the decoder whose bit lasts `bit` (more than 0): the frame of
    /// the sender, less than half a bit later, if it sent pulses at that rate; else levels (line_level()).
    std::vector<cosim::UartFrame> add(const cosim::UartFrame& frame, cosim::Time bit);
    /// What came in is forgotten; the line rests high, or low.
    void reset(bool rests_low = false) {
        low_until_ = 0;
        rests_low_ = rests_low;
    }
    bool rests_low() const { return rests_low_; }

    template <class Archive>
    void state(Archive& archive) {
        archive.bounded(low_until_, 0, cosim::kNever);
        archive(rests_low_);
    }

  private:
    cosim::Time low_until_ = 0;
    bool rests_low_ = false;  ///< the line, behind the last frame
};

}  // namespace puckloop::protocols
