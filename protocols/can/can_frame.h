#pragma once
// A CAN 2.0 data or remote frame, and the bits that it is on the wire. Source: Bosch CAN specification 2.0,
// parts A and B. A level is true where it is recessive.

#include <array>
#include <bitset>
#include <cstddef>
#include <cstdint>

namespace puckloop::protocols {

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

inline constexpr bool kRecessive = true, kDominant = false;
inline constexpr int kCrcBits = 15;
inline constexpr int kMostAlike = 5;  ///< after so many equal bits one of the other kind is stuffed
/// Bits behind the check sequence, none of them stuffed: CRC delimiter, acknowledge slot and delimiter, end
/// of frame.
inline constexpr int kCanTail = 1 + 2 + 7;
/// Bits of the longest frame: 118 from the start to the check sequence, a stuff bit for each four behind the
/// first five, the tail.
inline constexpr int kMostCanBits = 118 + 29 + kCanTail;

/// Levels from the start of frame to the end of the end-of-frame field, stuff bits included; recessive in the
/// acknowledge slot.
struct CanBits {
    std::bitset<kMostCanBits> levels{};
    int count = 0;
    int arbitration = 0;  ///< the last bit of the arbitration field (RTR)

    bool operator[](int bit) const { return levels[static_cast<std::size_t>(bit)]; }
    int acknowledge() const { return count - kCanTail + 1; }  ///< the acknowledge slot
};
CanBits can_levels(const CanFrame& frame);

/// The frame's 15-bit check sequence.
std::uint16_t can_crc(const CanFrame& frame);
/// The check sequence with one bit more.
std::uint16_t next_can_crc(std::uint16_t crc, bool bit);
/// Bits from the start of frame to the end of the end-of-frame field, stuff bits included.
int can_bits(const CanFrame& frame);

}  // namespace puckloop::protocols
