#include "emu/dspic/peripherals/can_frame.h"

#include <algorithm>
#include <vector>

namespace puckloop::dspic {

namespace {

constexpr int kStandardBits = 11;
constexpr int kExtendedBits = 18;
constexpr int kCrcBits = 15;
constexpr std::uint16_t kPolynomial = 0x4599;
constexpr int kMostAlike = 5;     // after so many equal bits one of the other kind is stuffed
constexpr int kTail = 1 + 2 + 7;  // CRC delimiter, acknowledge slot and delimiter, end of frame: not stuffed

/// From the start of frame to the last data bit.
std::vector<bool> head(const CanFrame& frame) {
    std::vector<bool> bits{false};
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
    unsigned crc = 0;
    for (const bool bit : bits) {
        const bool next = bit != static_cast<bool>(crc >> (kCrcBits - 1) & 1);
        crc = crc << 1 & 0x7FFF;
        if (next) crc ^= kPolynomial;
    }
    return static_cast<std::uint16_t>(crc);
}

}  // namespace

std::uint16_t can_crc(const CanFrame& frame) {
    return crc_of(head(frame));
}

int can_bits(const CanFrame& frame) {
    std::vector<bool> bits = head(frame);
    const std::uint16_t crc = crc_of(bits);
    for (int i = kCrcBits - 1; i >= 0; --i)
        bits.push_back(crc >> i & 1);
    int stuffed = 0, alike = 0;
    bool last = true;
    for (const bool bit : bits) {
        alike = bit == last ? alike + 1 : 1;
        last = bit;
        if (alike != kMostAlike) continue;
        ++stuffed;  // counts as the first of the next group
        last = !bit;
        alike = 1;
    }
    return static_cast<int>(bits.size()) + stuffed + kTail;
}

}  // namespace puckloop::dspic
