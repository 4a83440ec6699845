#include "tests/framing/uart_line.h"

#include <algorithm>
#include <bit>

namespace puckloop::framing {

using cosim::Time;
using cosim::UartFrame;

bool parity_bit(std::uint16_t data, int parity) {
    const bool odd = std::popcount(data) % 2 == 1;
    return parity == 2 ? odd : parity == 1 && !odd;
}

UartFrame frame_of(const Format& format, std::uint16_t data, Time start, Time bit_period) {
    UartFrame frame;
    frame.start = start;
    frame.bit_period = bit_period;
    frame.data = data;
    frame.data_bits = static_cast<std::uint8_t>(format.data_bits);
    frame.parity = static_cast<std::uint8_t>(format.parity);
    frame.stop_bits = static_cast<std::uint8_t>(format.stop_bits);
    frame.parity_bit = parity_bit(data, format.parity);
    return frame;
}

bool level_at(const std::vector<UartFrame>& line, Time time) {
    const auto after = std::upper_bound(line.begin(), line.end(), time,
                                        [](Time t, const UartFrame& frame) { return t < frame.start; });
    if (after == line.begin()) return true;
    const UartFrame& frame = *(after - 1);
    const Time bit = (time - frame.start) / frame.bit_period;
    const int bits = 1 + frame.data_bits + (frame.parity ? 1 : 0);
    if (frame.is_break) return bit >= bits + frame.stop_bits;
    if (bit == 0) return false;
    if (bit <= frame.data_bits) return frame.data >> (bit - 1) & 1;
    if (bit < bits) return frame.parity_bit;
    return true;
}

std::vector<Character> listen(const std::vector<UartFrame>& line, const Format& format, int ticks,
                              const std::function<Time(std::int64_t)>& tick) {
    if (line.empty()) return {};
    return listen([&](Time time) { return level_at(line, time); },
                  line.back().start + 32 * line.back().bit_period, format, ticks, tick);
}

std::vector<Character> listen(const std::function<bool(Time)>& level_of, Time end, const Format& format,
                              int ticks, const std::function<Time(std::int64_t)>& tick) {
    std::vector<Character> heard;
    const auto level = [&](std::int64_t n) { return level_of(tick(n)); };
    const auto vote = [&](std::int64_t middle) {
        if (ticks < 8) return level(middle);
        return level(middle - 1) + level(middle) + level(middle + 1) >= 2;
    };
    for (std::int64_t n = 1; tick(n) < end; ++n) {
        if (!level(n - 1) || level(n)) continue;
        const std::int64_t middle = n + ticks / 2;  // of the start bit
        if (vote(middle)) {                         // too short for one
            n = middle;
            continue;
        }
        Character character;
        int bit = 1;
        const auto next = [&] { return vote(middle + ticks * bit++); };
        int ones = 0;
        for (int i = 0; i < format.data_bits; ++i) {
            const bool high = next();
            ones += high;
            character.data = static_cast<std::uint16_t>(character.data | high << i);
        }
        if (format.parity) {
            ones += next();
            character.parity = (ones % 2 == 1) != (format.parity == 1);
        }
        for (int i = 0; i < format.stop_bits; ++i)
            character.framing = !next() || character.framing;
        heard.push_back(character);
        n = middle + ticks * (bit - 1);  // the stop bit's middle: a new start bit may follow at once
        while (!level(n) && tick(n) < end)
            ++n;
    }
    return heard;
}

Limits limits(const Format& format, int ticks, double wait) {
    // Middles of bits in ticks from the edge. With two stop bits the second one meets the next start bit.
    const auto middle = [&](double bit) { return ticks / 2.0 + wait + ticks * bit; };
    const double stop = format.bits_before_stop(), last = stop + format.stop_bits - 1;
    return {middle(stop) / (ticks * stop), middle(last) / (ticks * (last + 1))};
}

}  // namespace puckloop::framing
