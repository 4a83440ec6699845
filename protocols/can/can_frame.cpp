#include "protocols/can/can_frame.h"

#include <algorithm>
#include <vector>

namespace puckloop::protocols {

namespace {

constexpr int kStandardBits = 11;
constexpr int kExtendedBits = 18;
constexpr std::uint16_t kPolynomial = 0x4599;
constexpr std::uint16_t kCrcMask = 0x7FFF;
// Bits up to RTR, without stuff bits: start of frame, identifier (SRR and IDE within), RTR.
constexpr int kStandardArbitration = 1 + kStandardBits + 1;
constexpr int kExtendedArbitration = 1 + kStandardBits + 2 + kExtendedBits + 1;

/// From the start of frame to the last data bit.
std::vector<bool> head(const CanFrame& frame) {
    std::vector<bool> bits{kDominant};
    const auto put = [&](std::uint32_t value, int count) {
        while (count-- > 0)
            bits.push_back(value >> count & 1);
    };
    if (frame.extended) {
        put(frame.id >> kExtendedBits, kStandardBits);
        put(0b11, 2);  // SRR, IDE
        put(frame.id, kExtendedBits);
        put(frame.remote ? 0b100 : 0b000, 3);  // RTR, r1, r0
    } else {
        put(frame.id, kStandardBits);
        put(frame.remote ? 0b100 : 0b000, 3);  // RTR, IDE, r0
    }
    put(frame.length, 4);
    const int bytes = frame.remote ? 0 : std::min<int>(frame.length, 8);
    for (int i = 0; i < bytes; ++i)
        put(frame.data[static_cast<std::size_t>(i)], 8);
    return bits;
}

std::uint16_t crc_of(const std::vector<bool>& bits) {
    std::uint16_t crc = 0;
    for (const bool bit : bits)
        crc = next_can_crc(crc, bit);
    return crc;
}

}  // namespace

std::uint16_t next_can_crc(std::uint16_t crc, bool bit) {
    const bool next = bit != static_cast<bool>(crc >> (kCrcBits - 1) & 1);
    const unsigned shifted = crc << 1 & kCrcMask;
    return static_cast<std::uint16_t>(next ? shifted ^ kPolynomial : shifted);
}

std::uint16_t can_crc(const CanFrame& frame) {
    return crc_of(head(frame));
}

CanBits can_levels(const CanFrame& frame) {
    std::vector<bool> bits = head(frame);
    const std::uint16_t crc = crc_of(bits);
    for (int i = kCrcBits - 1; i >= 0; --i)
        bits.push_back(crc >> i & 1);
    const int arbitration = frame.extended ? kExtendedArbitration : kStandardArbitration;
    CanBits wire;
    const auto put = [&](bool level) { wire.levels[static_cast<std::size_t>(wire.count++)] = level; };
    int alike = 0, plain = 0;
    bool last = kRecessive;
    for (const bool bit : bits) {
        alike = bit == last ? alike + 1 : 1;
        last = bit;
        put(bit);
        if (++plain == arbitration) wire.arbitration = wire.count - 1;
        if (alike != kMostAlike) continue;
        last = !bit;  // counts as the first of the next group
        alike = 1;
        put(last);
    }
    for (int i = 0; i < kCanTail; ++i)
        put(kRecessive);
    return wire;
}

int can_bits(const CanFrame& frame) {
    return can_levels(frame).count;
}

}  // namespace puckloop::protocols
