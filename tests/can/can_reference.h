#pragma once
// CAN frames by the text of the specification, for tests: fields as characters, division of polynomials,
// stuffing by search. '0' is dominant.

#include "base/random.h"
#include "protocols/can/can_frame.h"

#include <algorithm>
#include <cstdint>
#include <string>

namespace puckloop::tests {

inline std::string binary(std::uint32_t value, int bits) {
    std::string text;
    while (bits-- > 0)
        text += value >> bits & 1 ? '1' : '0';
    return text;
}

/// From the start of frame to RTR, without stuff bits; what is read as a number decides who goes on.
inline std::string arbitration_text(const protocols::CanFrame& frame) {
    std::string bits = "0";
    if (frame.extended)
        bits += binary(frame.id >> 18, 11) + "11" + binary(frame.id & 0x3FFFF, 18);
    else
        bits += binary(frame.id, 11);
    return bits + (frame.remote ? "1" : "0");
}

/// The whole frame, recessive in the acknowledge slot.
inline std::string frame_text(const protocols::CanFrame& frame) {
    std::string bits = arbitration_text(frame) + "00" + binary(frame.length, 4);
    for (int i = 0; i < frame.length && !frame.remote; ++i)
        bits += binary(frame.data[static_cast<std::size_t>(i)], 8);
    const std::string divisor = "1100010110011001";
    std::string rest = bits + std::string(15, '0');
    for (std::size_t i = 0; i < bits.size(); ++i)
        if (rest[i] == '1')
            for (std::size_t j = 0; j < divisor.size(); ++j)
                rest[i + j] = rest[i + j] == divisor[j] ? '0' : '1';
    bits += rest.substr(bits.size());
    // Runs of five overlap a stuffed bit's own run only from that bit on, as find() from there has it.
    for (std::size_t at = 0;
         (at = std::min(bits.find("00000", at), bits.find("11111", at))) != std::string::npos;) {
        bits.insert(at + 5, 1, bits[at] == '0' ? '1' : '0');
        at += 5;
    }
    return bits + "1111111111";
}

inline int reference_bits(const protocols::CanFrame& frame) {
    return static_cast<int>(frame_text(frame).size());
}

inline protocols::CanFrame draw_frame(RandomStream& random) {
    protocols::CanFrame frame;
    frame.extended = random.below(2);
    frame.id = static_cast<std::uint32_t>(random.below(frame.extended ? 1u << 29 : 1u << 11));
    frame.remote = random.below(5) == 0;
    frame.length = static_cast<std::uint8_t>(random.below(9));
    if (!frame.remote)
        for (int i = 0; i < frame.length; ++i)
            frame.data[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(random.below(256));
    return frame;
}

}  // namespace puckloop::tests
