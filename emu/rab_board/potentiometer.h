#pragma once
// The digital potentiometer that sets the emitters' current: one frame of 8 bits without command byte,
// shifted in while its select line is low, taken over when the line rises; the wiper is settled some time
// later. Source: range-and-bearing fact sheet 2.1 (register 12), 5.2.
//
// Deviations: 1. the wiper stands still and then jumps; silicon moves within the settling time. 2. Nothing is
// shifted out; the line to the chip reads 0.

#include "cosim/core/time.h"

#include <cstdint>
#include <optional>

namespace puckloop::rab {

/// "settling about 1 ms": the firmware's author waits that long after a byte.
inline constexpr cosim::Time kPotentiometerSettling = cosim::kMillisecond;

class Potentiometer {
  public:
    explicit Potentiometer(std::uint8_t byte, cosim::Time settling = kPotentiometerSettling)
        : settling_(settling), wiper_(byte), latched_(byte) {}

    /// Level of the select line from `now` on.
    void select(bool high, cosim::Time now);
    /// `bits` bits were shifted in; ignored unless selected.
    void shift(std::uint16_t sent, int bits);

    /// When the wiper reaches the byte latched last; kNever while it stands.
    cosim::Time due() const { return due_; }
    /// To be called at due(): the new position.
    std::uint8_t settle();
    std::uint8_t wiper() const { return wiper_; }
    std::uint64_t bytes() const { return bytes_; }  ///< latched so far

    template <class Archive>
    void state(Archive& archive) {
        archive(high_, shifted_, wiper_, latched_, bytes_);
        archive.bounded(due_, 0, cosim::kNever);
    }

  private:
    cosim::Time settling_;
    bool high_ = true;
    std::optional<std::uint8_t> shifted_;
    std::uint8_t wiper_;
    std::uint8_t latched_;
    cosim::Time due_ = cosim::kNever;
    std::uint64_t bytes_ = 0;
};

}  // namespace puckloop::rab
