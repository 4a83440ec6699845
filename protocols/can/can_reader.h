#pragma once
// Reads a CAN frame bit by bit, as every controller on the bus does, the sender included: takes stuff bits
// out, checks form and check sequence. Source: Bosch CAN specification 2.0, parts A and B.

#include "protocols/can/can_frame.h"

#include <bitset>
#include <cstdint>
#include <string_view>

namespace puckloop::protocols {

enum class CanError : std::uint8_t {
    None,
    Bit,          ///< a sender reads another level than it sent
    Stuff,        ///< six equal bits in a row
    Form,         ///< a dominant bit where the format has a recessive one
    Acknowledge,  ///< nobody took the frame
    Crc           ///< the check sequence is another one; reported at the acknowledge delimiter
};
/// "bit", "stuff", ...; empty for None.
std::string_view can_error_name(CanError error);

class CanReader {
  public:
    /// The next bit, the start of frame first. Not to be called behind an error or the end.
    CanError take(bool level);

    int taken() const { return state_.taken; }  ///< bits so far, stuff bits included
    /// The bit before the acknowledge slot has been read, and the check sequence is right.
    bool acknowledges() const { return state_.tail == 1 && !state_.bad; }
    /// Complete for a receiver: all but the last bit of the end of frame.
    bool valid() const { return state_.tail >= kCanTail - 1; }
    bool ended() const { return state_.tail == kCanTail; }
    /// At least so many bits are still to come, stuff bits left out.
    int left() const;
    /// What has been read; whole once the check sequence has been.
    CanFrame frame() const;

  private:
    static constexpr int kMostPlain = 118;
    struct State {
        std::bitset<kMostPlain> bits{};  ///< without stuff bits
        std::uint8_t taken = 0, plain = 0, alike = 0, tail = 0;
        bool last = kRecessive;
        bool bad = false;  ///< the check sequence
        std::uint16_t crc = 0;
    };
    std::uint32_t field(int first, int count) const;
    bool extended() const { return state_.bits[13]; }
    int head() const { return extended() ? 39 : 19; }  ///< bits up to the DLC
    int bytes() const;
    /// Bits up to the check sequence's last one; what is not known yet counts as little as it can.
    int plain_bits() const;

    State state_;
};

}  // namespace puckloop::protocols
