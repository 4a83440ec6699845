#pragma once
// A CAN 2.0 data or remote frame, and how long it is on the wire. Source: Bosch CAN specification 2.0, parts
// A and B.

#include <array>
#include <cstdint>

namespace puckloop::dspic {

struct CanFrame {
    std::uint32_t id = 0;  ///< 11 bits; extended: 29, the standard identifier on top
    bool extended = false;
    bool remote = false;
    std::uint8_t length = 0;  ///< DLC: 0..8
    std::array<std::uint8_t, 8> data{};

    friend bool operator==(const CanFrame&, const CanFrame&) = default;
    template <class Archive>
    void state(Archive& archive) {
        archive(id, extended, remote);
        archive.bounded(length, 0, 8);
        archive(data);
    }
};

/// What became of a frame that was sent.
enum class CanOutcome : std::uint8_t {
    Acknowledged,
    NotAcknowledged,  ///< nobody there, or nobody who listens
    BitError          ///< somebody destroyed it
};

/// The frame's 15-bit check sequence.
std::uint16_t can_crc(const CanFrame& frame);
/// Bits from the start of frame to the end of the end-of-frame field, stuff bits included.
int can_bits(const CanFrame& frame);

}  // namespace puckloop::dspic
