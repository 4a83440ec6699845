#include "protocols/serial/uart_sampling.h"

#include "protocols/serial/irda.h"

#include <algorithm>
#include <bit>

namespace puckloop::protocols {

using cosim::Time;
using cosim::UartFrame;

namespace {
/// A glitch's edge that a rounding to whole nanoseconds took from a bit's boundary is there.
Time edge_of(const UartFrame& frame, Time since_start) {
    const Time off = (since_start + frame.bit_period / 2) % frame.bit_period - frame.bit_period / 2;
    return frame.start + since_start - (off > -cosim::kNanosecond && off < cosim::kNanosecond ? off : 0);
}
Time glitch_start(const UartFrame& frame) {
    return edge_of(frame, Time{frame.glitch_at} * cosim::kNanosecond);
}
Time glitch_end(const UartFrame& frame) {
    return edge_of(frame, (Time{frame.glitch_at} + frame.glitch_width) * cosim::kNanosecond);
}
bool has_glitch(const UartFrame& frame) {
    return frame.glitch_width != 0 && !is_infrared(frame);
}
bool in_glitch(const UartFrame& frame, Time time) {
    return has_glitch(frame) && time >= glitch_start(frame) && time < glitch_end(frame);
}

/// As the sender meant it; bit 0 is the start bit.
bool bit_is_mark(const UartFrame& frame, Time bit) {
    if (frame.is_break != 0 || bit == 0) return false;
    if (bit <= frame.data_bits) return (frame.data >> (bit - 1) & 1u) != 0;
    if (frame.parity != 0 && bit == frame.data_bits + 1) return frame.parity_bit != 0;
    return true;
}

// IrDA's pulse, in sixteenths of a bit.
constexpr Time kPulseFrom = 7, kPulseTo = 10, kSixteenths = 16;

Time pulse_edge(const UartFrame& frame, Time sixteenth) {
    return frame.bit_period * sixteenth / kSixteenths;
}

bool in_pulse(const UartFrame& frame, Time since_bit) {
    return since_bit >= pulse_edge(frame, kPulseFrom) && since_bit < pulse_edge(frame, kPulseTo);
}

/// The next instant at or after `from` at which the frame's line is low, or kNever.
Time next_low(const UartFrame& frame, Time from) {
    const Time end = frame_end(frame);
    for (from = std::max(from, frame.start); from < end; from = next_change(frame, from))
        if (!line_is_mark(frame, from)) return from;
    return cosim::kNever;
}

/// The next falling edge at or after `from`; a line already low at `from` counts only once it has been high.
Time next_falling_edge(const UartFrame& frame, Time from) {
    const Time end = frame_end(frame);
    if (from > frame.start) {
        while (from < end && !line_is_mark(frame, from))
            from = next_change(frame, from);
    }
    return next_low(frame, from);
}

}  // namespace

int bits_before_stop(const UartFrame& frame) {
    return 1 + frame.data_bits + (frame.parity != 0 ? 1 : 0);
}

Time stop_bit_start(const UartFrame& frame) {
    return frame.start + bits_before_stop(frame) * frame.bit_period;
}

Time frame_end(const UartFrame& frame) {
    return stop_bit_start(frame) + frame.stop_bits * frame.bit_period;
}

bool line_is_mark(const UartFrame& frame, Time time) {
    if (time < frame.start) return true;
    if (time >= frame_end(frame)) return (frame.line & cosim::kLineRestsLow) == 0;
    bool meant = bit_is_mark(frame, (time - frame.start) / frame.bit_period);
    if (is_infrared(frame)) meant = meant || !in_pulse(frame, (time - frame.start) % frame.bit_period);
    const bool inverted = (frame.line & cosim::kLineInverted) != 0;
    return (meant != inverted) != in_glitch(frame, time);
}

Time next_change(const UartFrame& frame, Time time) {
    if (time < frame.start) return frame.start;
    const Time end = frame_end(frame);
    if (time >= end) return cosim::kNever;
    const Time bit = frame.start + (time - frame.start) / frame.bit_period * frame.bit_period;
    Time next = bit + frame.bit_period;
    if (is_infrared(frame))
        for (const Time sixteenth : {kPulseFrom, kPulseTo})
            if (const Time edge = bit + pulse_edge(frame, sixteenth); edge > time)
                next = std::min(next, edge);
    if (has_glitch(frame))
        for (const Time edge : {glitch_start(frame), glitch_end(frame)})
            if (edge > time) next = std::min(next, edge);
    return std::min(next, end);
}

ReceivedCharacter take_character(const std::function<bool(Time)>& level, const UartReceiver& receiver,
                                 Time edge) {
    ReceivedCharacter character;
    character.start = edge;
    bool all_low = true;
    int bit = 1;
    const auto sample = [&] {
        const Time middle = edge + receiver.bit_period * bit + receiver.bit_period / 2;
        ++bit;
        character.time = middle;
        const bool mark = level(middle);
        all_low = all_low && !mark;
        return mark;
    };
    for (int i = 0; i < receiver.data_bits; ++i) {
        if (sample()) character.data = static_cast<std::uint16_t>(character.data | (1u << i));
    }
    if (receiver.parity != 0) {
        const int ones = std::popcount(character.data) + (sample() ? 1 : 0);
        character.parity_error = (ones % 2 == 1) != (receiver.parity == 1);
    }
    character.framing_error = !sample();
    character.is_break = all_low;
    return character;
}

std::vector<ReceivedCharacter> sample_frame(const UartFrame& frame, const UartReceiver& receiver,
                                            Time ready) {
    std::vector<ReceivedCharacter> characters;
    Time edge = next_falling_edge(frame, ready);
    while (edge != cosim::kNever) {
        const Time middle = edge + receiver.bit_period / 2;
        if (line_is_mark(frame, middle)) {  // too short for a start bit
            edge = next_falling_edge(frame, middle);
            continue;
        }
        characters.push_back(
            take_character([&](Time time) { return line_is_mark(frame, time); }, receiver, edge));
        edge = next_falling_edge(frame, characters.back().time);
    }
    return characters;
}

}  // namespace puckloop::protocols
