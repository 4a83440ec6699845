#pragma once
// What the range-and-bearing frame's redundancy is worth: every error of a kind is done to one frame and the
// receiver's answers are counted.
//
// With ones and zeros of the payload, n = size + 4 bits and L = 6 + 2n chips:
//   one chip inverted     all L are found: 6 by the preamble, 2n by Manchester, for the other chip of its bit
//                         stands
//   two chips inverted    found too, all L(L-1)/2: by Manchester unless both chips are of one bit; those n
//                         clean flips change the check's sum by 1, 2, 4 or 8, never by 16
//   one chip lost, added  found at the latest by the length
//   two bits flipped      (four chips) the smallest errors that pass: a set and a clear bit of the payload,
//                         ones * zeros of them, keep the number of ones; and a payload bit together with the
//                         check's lowest bit, if one goes up by what the other goes down: zeros of them if
//                         the check is odd, ones if it is even

#include <array>
#include <cstdint>
#include <string_view>

namespace puckloop::protocols {

enum class RabError { OneInverted, TwoInverted, OneLost, OneAdded, TwoBits };
inline constexpr std::array kRabErrors{RabError::OneInverted, RabError::TwoInverted, RabError::OneLost,
                                       RabError::OneAdded, RabError::TwoBits};

/// "one chip inverted" and so on.
std::string_view name_of(RabError error);

/// How many errors of one kind the receiver found, by what; and how many it missed, why.
struct RabErrorCount {
    int preamble = 0;
    int manchester = 0;
    int length = 0;
    int check = 0;
    int missed_swap = 0;      ///< the payload changed, its number of ones did not
    int missed_followed = 0;  ///< the check changed as the number of ones did
    int found() const { return preamble + manchester + length + check; }
    int missed() const { return missed_swap + missed_followed; }
    int all() const { return found() + missed(); }
    bool operator==(const RabErrorCount&) const = default;
};

/// All errors of a kind at a frame, met by a receiver set to the frame's size. A lost chip is left out, an
/// added one is 0 or 1 before any chip or after the last. Throws InputError as encode_rab does.
RabErrorCount count_rab_errors(RabError error, int size, std::uint32_t payload);

}  // namespace puckloop::protocols
