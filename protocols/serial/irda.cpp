#include "protocols/serial/irda.h"

#include "protocols/serial/uart_line.h"
#include "protocols/serial/uart_sampling.h"

#include <algorithm>
#include <utility>

namespace puckloop::protocols {

using cosim::Time;
using cosim::UartFrame;

namespace {

constexpr Time kLate = 7, kBitSixteenths = 16;  ///< from a bit to its pulse

/// Rates so close that ten bits decode alike.
bool same_rate(Time a, Time b) {
    constexpr Time kParts = 50;  // 2 %: a fifth of a bit in ten
    return a > b ? (a - b) * kParts < b : (b - a) * kParts < b;
}

}  // namespace

std::vector<UartFrame> IrdaDecoder::add(const UartFrame& frame, Time bit) {
    const bool low_before = std::exchange(rests_low_, (frame.line & cosim::kLineRestsLow) != 0);
    if (is_infrared(frame) && frame.line == 0 && same_rate(frame.bit_period, bit)) {
        UartFrame decoded = frame;
        decoded.glitch_width = 0;
        decoded.start += frame.bit_period * kLate / kBitSixteenths;
        low_until_ = std::min(low_until_, decoded.start);
        return {decoded};
    }
    std::vector<UartFrame> levels;
    bool low = low_before;
    const Time end = frame_end(frame);
    for (Time time = frame.start; time <= end; time = next_change(frame, time)) {
        const bool was_low = std::exchange(low, !line_is_mark(frame, time));
        if (!low || was_low) continue;
        const Time from = std::max(time, low_until_);
        low_until_ = from + bit;
        levels.push_back(line_level(false, from, frame.bit_period));
        levels.push_back(line_level(true, low_until_, frame.bit_period));
    }
    return levels;
}

}  // namespace puckloop::protocols
