#pragma once
// A serial line as levels over time, and a receiver that looks at it as the data sheets say: a sampling clock
// of S ticks a bit, the start bit seen at the first tick that reads low, each bit read at its middle, with 16
// and 8 ticks by a majority of three. Written apart from the chips' models, to judge them.
// Sources: dsPIC30F Family Reference Manual, section 19; ATmega1284P data sheet 8272, "Asynchronous Data
// Reception".

#include "cosim/core/message.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace puckloop::framing {

struct Format {
    int data_bits = 8;
    int parity = 0;     ///< 0 none, 1 odd, 2 even
    int stop_bits = 1;  ///< sent, and looked at by the receiver
    int bits_before_stop() const { return 1 + data_bits + (parity ? 1 : 0); }
    friend bool operator==(const Format&, const Format&) = default;
};

struct Character {
    std::uint16_t data = 0;
    bool framing = false, parity = false;
    bool overrun = false;  ///< characters were lost before this one (ATmega's DOR)
    friend bool operator==(const Character&, const Character&) = default;
};

/// The parity bit of `data`.
bool parity_bit(std::uint16_t data, int parity);
/// A frame as a sender with this format sends it.
cosim::UartFrame frame_of(const Format& format, std::uint16_t data, cosim::Time start,
                          cosim::Time bit_period);
/// Level of the line at `time`: `line` in order of starts, without overlaps; high between frames.
bool level_at(const std::vector<cosim::UartFrame>& line, cosim::Time time);

/// What the reference receiver takes off a line with these levels up to `end`.
std::vector<Character> listen(const std::function<bool(cosim::Time)>& level, cosim::Time end,
                              const Format& format, int ticks,
                              const std::function<cosim::Time(std::int64_t)>& tick);
/// What the reference receiver takes off the line up to its end. `tick(n)`: time of tick n >= 0.
std::vector<Character> listen(const std::vector<cosim::UartFrame>& line, const Format& format, int ticks,
                              const std::function<cosim::Time(std::int64_t)>& tick);

/// The mismatch at which errors begin, as length of the sender's bits over the receiver's, by theory. `wait`
/// is the time from the start bit's edge to the tick that sees it, in ticks, 0 (included) to 1.
struct Limits {
    double longest = 0;   ///< longer bits: the last bit before the stop bit is read in the stop bit's place
    double shortest = 0;  ///< shorter bits, back to back: the next start bit is read for the stop bit
};
Limits limits(const Format& format, int ticks, double wait);

}  // namespace puckloop::framing
