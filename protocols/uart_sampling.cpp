#include "protocols/uart_sampling.h"

#include <bit>

namespace puckloop::protocols {

using cosim::Time;
using cosim::UartFrame;

namespace {
/// The next instant at or after `from` at which the frame's line is low, or kNever. Level changes happen on
/// the sender's bit boundaries only.
Time next_low(const UartFrame& frame, Time from) {
    const Time end = frame_end(frame);
    if (from < frame.start) from = frame.start;
    while (from < end) {
        if (!line_is_mark(frame, from)) return from;
        from = frame.start + ((from - frame.start) / frame.bit_period + 1) * frame.bit_period;
    }
    return cosim::kNever;
}

/// The next falling edge at or after `from`; a line already low at `from` counts only once it has been high.
Time next_falling_edge(const UartFrame& frame, Time from) {
    const Time end = frame_end(frame);
    if (from > frame.start) {
        while (from < end && !line_is_mark(frame, from))
            from = frame.start + ((from - frame.start) / frame.bit_period + 1) * frame.bit_period;
    }
    return next_low(frame, from);
}

ReceivedCharacter take_character(const UartFrame& frame, const UartReceiver& receiver, Time edge) {
    ReceivedCharacter character;
    character.start = edge;
    bool all_low = true;
    int bit = 1;
    const auto sample = [&] {
        const Time middle = edge + receiver.bit_period * bit + receiver.bit_period / 2;
        ++bit;
        character.time = middle;
        const bool mark = line_is_mark(frame, middle);
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
    if (time < frame.start || time >= frame_end(frame)) return true;
    if (frame.is_break != 0) return false;
    const Time index = (time - frame.start) / frame.bit_period;
    if (index == 0) return false;
    if (index <= frame.data_bits) return (frame.data >> (index - 1) & 1u) != 0;
    if (frame.parity != 0 && index == frame.data_bits + 1) return frame.parity_bit != 0;
    return true;
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
        characters.push_back(take_character(frame, receiver, edge));
        edge = next_falling_edge(frame, characters.back().time);
    }
    return characters;
}

}  // namespace puckloop::protocols
