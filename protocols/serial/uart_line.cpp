#include "protocols/serial/uart_line.h"

#include <algorithm>

namespace puckloop::protocols {

using cosim::kNever;
using cosim::Time;
using cosim::UartFrame;

namespace {

int bit_count(const UartFrame& frame) {
    return bits_before_stop(frame) + frame.stop_bits;
}

/// No frame of a sender but a level from its start on, up to whatever comes next.
bool is_level(const UartFrame& frame) {
    return frame.is_break != 0 && (frame.line == cosim::kLineInverted || frame.line == cosim::kLineRestsLow);
}

// Level of bit `index` of a frame, 0 = start bit.
bool bit_level(const UartFrame& frame, int index) {
    return line_is_mark(frame, frame.start + frame.bit_period * index);
}

}  // namespace

UartFrame line_level(bool high, Time from, Time bit) {
    UartFrame frame;
    frame.start = from;
    frame.bit_period = bit;
    frame.is_break = 1;
    frame.line = high ? cosim::kLineInverted : cosim::kLineRestsLow;
    return frame;
}

void UartLine::add(const UartFrame& frame) {
    // Sound frames come in order, or overlap as they came.
    auto place = frames_.end();
    if (!frames_.empty() && (!is_sound(frame) || !sound()))
        place = std::upper_bound(frames_.begin(), frames_.end(), frame.start,
                                 [](Time start, const UartFrame& other) { return start < other.start; });
    frames_.insert(place, frame);
}

bool UartLine::level(Time time) const {
    for (auto frame = frames_.rbegin(); frame != frames_.rend(); ++frame) {
        if (time < frame->start) continue;
        return line_is_mark(*frame, time);
    }
    return true;
}

bool UartLine::at_rest(Time time) const {
    return frames_.empty() || (frame_end(last()) <= time && level(time - 1));
}

Time UartLine::known_until() const {
    return is_level(last()) ? last().start : frame_end(last());
}

bool UartLine::sound(Time shortest) const {
    return std::all_of(frames_.begin(), frames_.end(), [shortest](const UartFrame& frame) {
        return is_sound(frame) && frame.bit_period >= shortest;
    });
}

Time UartLine::longest_flight() const {
    Time longest = 0;
    for (const UartFrame& frame : frames_)
        longest = std::max(longest, frame.bit_period * bits_before_stop(frame));
    return longest;
}

Time UartLine::next_change(Time time) const {
    Time next = kNever;
    for (const UartFrame& frame : frames_)
        next = std::min(next, protocols::next_change(frame, time));
    return next;
}

std::optional<Time> UartLine::falling_edge(Time from) const {
    if (sound()) return sound_falling_edge(from);
    for (Time edge = from; edge != kNever; edge = next_change(edge))
        if (!level(edge) && level(edge - 1)) return edge;
    return std::nullopt;
}

// Levels change on the senders' bit boundaries only.
std::optional<Time> UartLine::sound_falling_edge(Time from) const {
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

Time UartLine::first_high(Time from) const {
    if (level(from)) return from;
    if (!sound()) {
        Time time = from;
        while (time != kNever && !level(time))
            time = next_change(time);
        return time == kNever ? from : time;
    }
    for (const UartFrame& frame : frames_) {
        for (int i = 1; i <= bit_count(frame); ++i) {
            const Time edge = frame.start + frame.bit_period * i;
            if (edge >= from && level(edge)) return edge;
        }
    }
    return from;
}

void UartLine::forget_before(Time time) {
    // The last frame stays: whether the next one begins with an edge hangs on it.
    while (frames_.size() > 1 && frame_end(frames_[0]) <= time && frames_[1].start <= time)
        frames_.pop_front();
}

bool UartListener::samples_alone(const UartFrame& frame) const {
    if (!is_sound(frame)) return false;
    if (line_.empty()) return true;
    if (ask_again_ != kNever || (!line_.sound() && !line_.at_rest(frame.start))) return false;
    // A sound frame, too, has no edge at its start if it follows one without a stop bit.
    const UartFrame& last = line_.last();
    return last.is_break != 0 || frame.start < stop_bit_start(last) || line_.level(frame.start - 1);
}

void UartListener::reset() {
    line_.clear();
    ask_again_ = kNever;
}

std::vector<ReceivedCharacter> UartListener::add(const UartFrame& frame, const UartReceiver& receiver,
                                                 Time now) {
    // With nothing pending all edges before this frame have been dealt with.
    line_.forget_before(ask_again_ == kNever ? frame.start : ready_);
    if (samples_alone(frame)) {
        reset();
        line_.add(frame);
        auto characters = sample_frame(frame, receiver, ready_);
        if (!characters.empty()) ready_ = characters.back().time;
        return characters;
    }
    line_.add(frame);
    return pass(receiver, now);
}

std::vector<ReceivedCharacter> UartListener::pass(const UartReceiver& receiver, Time now) {
    std::vector<ReceivedCharacter> characters;
    ask_again_ = kNever;
    const Time bit = receiver.bit_period;
    if (line_.empty() || bit <= 0) return characters;
    const Time known = line_.known_until();
    // What the line is at `time`, as far as it matters, is certain by then.
    const auto certain = [&](Time time) {
        if (time < known) return true;
        const Time by = time + std::max(line_.longest_flight(), bit * (1 + receiver.data_bits));
        if (now >= by) return true;
        ask_again_ = by;
        return false;
    };
    while (const auto edge = line_.falling_edge(ready_)) {
        const Time middle = *edge + bit / 2;
        if (!certain(middle)) break;
        if (line_.level(middle)) {  // too short for a start bit
            ready_ = middle;
            continue;
        }
        const int bits = 1 + receiver.data_bits + (receiver.parity != 0 ? 1 : 0);
        if (!certain(middle + bit * bits)) break;
        characters.push_back(
            take_character([this](Time time) { return line_.level(time); }, receiver, *edge));
        ready_ = characters.back().time;
    }
    return characters;
}

}  // namespace puckloop::protocols
