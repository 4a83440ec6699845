#pragma once
// Looks at the emitters and reports which infra-red frames went out: for the log and the report, it changes
// nothing. Chips are counted at their nominal length, so a frame that was stretched on its way (a transfer on
// I2C holds the firmware up) counts as irregular, as it would for most receivers.

#include "cosim/core/time.h"

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace puckloop::rab {

/// One frame as the emitters sent it; emitters may carry different payloads.
struct EmittedFrame {
    cosim::Time start = 0;
    cosim::Time seen = 0;                             ///< when it was clear that it had ended
    int size = 0;                                     ///< payload bits
    std::map<std::uint32_t, std::uint16_t> payloads;  ///< payload and its emitters, bit 0 is emitter 1
};

class FrameWatch {
  public:
    std::function<void(const EmittedFrame&)> on_frame;
    /// Light that is no frame, from `start` on.
    std::function<void(cosim::Time start, cosim::Time seen, std::size_t chips)> on_irregular;

    /// Emitters that are on from `now` on.
    void change(std::uint16_t emitters, cosim::Time now);
    /// Time has come to `now`: what ended before it is reported.
    void settle(cosim::Time now);

    std::uint64_t frames() const { return frames_; }
    std::uint64_t irregular() const { return irregular_; }

    template <class Archive>
    void state(Archive& archive) {
        archive(emitters_, chips_, overlong_, frames_, irregular_);
        archive.bounded(since_, 0, cosim::kNever);
        archive.bounded(began_, 0, cosim::kNever);
        archive.check(chips_.size() <= kLongestBurst, "a burst too long");
    }

    /// Ten frames wait at most behind the one on air, of at most 78 chips: longer bursts are none of frames.
    static constexpr std::size_t kLongestBurst = 1000;

  private:
    void append(cosim::Time until);
    void close(cosim::Time seen);
    bool ends_at(std::size_t end) const;
    std::size_t frame_at(std::size_t first, EmittedFrame& frame) const;

    std::uint16_t emitters_ = 0;
    cosim::Time since_ = 0;             // of emitters_
    cosim::Time began_ = 0;             // the burst
    std::vector<std::uint16_t> chips_;  // of the burst; empty: silence
    bool overlong_ = false;
    std::uint64_t frames_ = 0, irregular_ = 0;
};

}  // namespace puckloop::rab
