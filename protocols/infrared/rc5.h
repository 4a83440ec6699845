#pragma once
// RC5, the infra-red remote control's format, as a demodulating receiver puts it on a pin: high at rest, low
// while the 36 kHz carrier is on. Source: Philips, "RC-5 remote control protocol" (64 carrier periods a bit).
//
// Fourteen Manchester bits: two start bits 1, the toggle bit, five of address, six of command, each most
// significant first. A 1 is high, then low; so the level in a bit's first half is the bit. The first start
// bit's first half is rest, which is why a frame shows half a bit after it began.

#include <vector>

namespace puckloop::protocols {

inline constexpr int kRc5HalfBitMicroseconds = 889;
inline constexpr int kRc5Bits = 14;
inline constexpr int kRc5LastAddress = 31;
inline constexpr int kRc5LastCommand = 63;
/// From the start of a frame to that of its repetition while the key is held: 64 bits.
inline constexpr int kRc5RepeatMicroseconds = 2 * 64 * kRc5HalfBitMicroseconds;

/// A change of the receiver's output.
struct Rc5Edge {
    int microseconds = 0;  ///< after the start of the frame
    bool high = true;
};

/// One frame, from its first falling edge to the edge that brings the line back to rest. `address` 0..31,
/// `command` 0..63; the rest of a larger number is ignored. `toggle` changes with each press of a key.
std::vector<Rc5Edge> rc5_frame(bool toggle, int address, int command);

}  // namespace puckloop::protocols
