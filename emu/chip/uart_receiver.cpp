#include "emu/chip/uart_receiver.h"

#include "protocols/uart_sampling.h"

namespace puckloop::chip {

using cosim::Time;
using cosim::UartFrame;

using protocols::bits_before_stop;
using protocols::frame_end;
using protocols::line_is_mark;

namespace {

// Level of bit `index` of a frame, 0 = start bit.
bool bit_level(const UartFrame& frame, int index) {
    return line_is_mark(frame, frame.start + frame.bit_period * index);
}

int bit_count(const UartFrame& frame) {
    return bits_before_stop(frame) + frame.stop_bits;
}

}  // namespace

void UartReceiver::start(Cycle at) {
    listening_from_ = clock_.time_of(at);
    ask_again_ = kNoCycle;
}

void UartReceiver::frame(const UartFrame& frame) {
    frames_.push_back(frame);
}

bool UartReceiver::level(Time time) const {
    for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
        if (time < frame->start) continue;
        return line_is_mark(*frame, time);
    }
    return true;
}

// The first change from high to low at or after `from`; the line rests high.
std::optional<Time> UartReceiver::falling_edge(Time from) const {
    for (const UartFrame& frame : frames_) {
        if (frame_end(frame) < from) continue;
        for (int i = 0; i < bit_count(frame); ++i) {
            const Time edge = frame.start + frame.bit_period * i;
            if (edge < from || bit_level(frame, i)) continue;
            const bool before = i > 0 ? bit_level(frame, i - 1) : level(edge - 1);
            if (before) return edge;
        }
    }
    return std::nullopt;
}

Time UartReceiver::first_high(Time from) const {
    if (level(from)) return from;
    for (const UartFrame& frame : frames_) {
        for (int i = 1; i <= bit_count(frame); ++i) {
            const Time edge = frame.start + frame.bit_period * i;
            if (edge >= from && level(edge)) return edge;
        }
    }
    return from;
}

void UartReceiver::forget_before(Time time) {
    // The last frame stays: whether the next one begins with an edge hangs on it.
    while (frames_.size() > 1 && frame_end(frames_[0]) <= time && frames_[1].start <= time)
        frames_.pop_front();
}

std::optional<UartReceiver::Character> UartReceiver::next(const Format& format, Cycle now) {
    ask_again_ = kNoCycle;
    const Cycle bit_cycles = static_cast<Cycle>(format.ticks) * format.divisor;
    Cycle first = 0;
    for (;;) {
        const std::optional<Time> edge = falling_edge(listening_from_);
        if (!edge) {
            forget_before(listening_from_);
            return std::nullopt;
        }
        // The edge is seen at the next tick of the 16x clock; bit centres are 8, 24, 40, ... ticks later (of
        // the 4x clock: 2, 6, 10, ...).
        const Cycle seen = clock_.first_cycle_at(*edge);
        const Cycle late = seen > format.phase ? (seen - format.phase) % format.divisor : 0;
        first = seen + (late ? format.divisor - late : 0) + format.ticks / 2 * format.divisor;
        if (!level(clock_.time_of(first))) break;
        listening_from_ = clock_.time_of(first);  // too short for a start bit
    }
    const auto centre = [&](int bit) { return clock_.time_of(first + bit_cycles * static_cast<Cycle>(bit)); };
    const int stop = 1 + format.data_bits + (format.parity ? 1 : 0);
    const int last_stop = stop + format.stop_bits - 1;
    const Cycle done = first + bit_cycles * static_cast<Cycle>(last_stop);

    // Beyond the last known frame another may already have begun whose message is still to come.
    const UartFrame& last = frames_.back();
    if (centre(last_stop) >= frame_end(last)) {
        const Cycle certain =
            clock_.first_cycle_at(centre(last_stop) + last.bit_period * bits_before_stop(last)) + 1;
        if (now < certain) {
            ask_again_ = certain;
            return std::nullopt;
        }
    }

    Character character;
    character.done = done;
    int ones = 0;
    for (int i = 0; i < format.data_bits; ++i) {
        const bool high = level(centre(1 + i));
        character.data = static_cast<std::uint16_t>(character.data | (high ? 1u << i : 0u));
        ones += high;
    }
    if (format.parity) {
        ones += level(centre(stop - 1));
        character.parity_error = (ones % 2 == 1) != (format.parity == 1);
    }
    const Time stop_time = centre(last_stop);
    for (int i = stop; i <= last_stop; ++i)
        character.framing_error = character.framing_error || !level(centre(i));
    // After a framing error, a break above all, the line must rest before a start bit counts.
    listening_from_ = character.framing_error ? first_high(stop_time) : stop_time;
    return character;
}

}  // namespace puckloop::chip
