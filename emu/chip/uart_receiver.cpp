#include "emu/chip/uart_receiver.h"

#include "protocols/serial/uart_sampling.h"

#include <algorithm>

namespace puckloop::chip {

using cosim::Time;
using cosim::UartFrame;

using protocols::bits_before_stop;

namespace {
constexpr std::uint32_t kVotingTicks = 8;  // so many or more sampling clocks in a bit: three are asked
constexpr int kVoters = 3;
}  // namespace

void UartReceiver::start(Cycle at) {
    listening_from_ = clock_.time_of(at);
    ask_again_ = kNoCycle;
    newest_ = 0;
}

void UartReceiver::frame(const UartFrame& frame) {
    if (switched_at_ != kNotSwitched) {
        if (frame.start <= switched_at_) line_.clear();  // it was on its way: this is what the line is
        switched_at_ = kNotSwitched;
    }
    line_.add(frame);
}

void UartReceiver::set_rest(bool high, Cycle at) {
    const Time time = clock_.time_of(at);
    const bool was_high = line_.level(time);
    line_.clear();
    if (!was_high) line_.add(protocols::line_level(false, time - 1, 1));
    if (high != was_high) line_.add(protocols::line_level(high, time, 1));
    switched_at_ = time;
}

bool UartReceiver::sample(const Format& format, Cycle middle, bool exact) const {
    if (!exact || format.ticks < kVotingTicks) return line_.level(clock_.time_of(middle));
    int high = 0;
    for (const Cycle cycle : {middle - format.divisor, middle, middle + format.divisor})
        high += line_.level(clock_.time_of(cycle));
    return 2 * high > kVoters;
}

/// Beyond the last known frame another may already have begun whose message is still to come.
bool UartReceiver::may_change(Time time, Cycle now, Time own_flight, bool exact) {
    const UartFrame& last = line_.last();
    if (time < line_.known_until()) return false;
    const Time flight =
        exact ? std::max(line_.longest_flight(), own_flight) : last.bit_period * bits_before_stop(last);
    const Cycle certain = clock_.first_cycle_at(time + flight) + 1;
    if (now >= certain) return false;
    ask_again_ = certain;
    return true;
}

std::optional<UartReceiver::Character> UartReceiver::next(const Format& format, Cycle now) {
    ask_again_ = kNoCycle;
    const Cycle bit_cycles = static_cast<Cycle>(format.ticks) * format.divisor;
    const bool votes = format.ticks >= kVotingTicks;
    // Exact: each sample counts, as some may fall into levels that others miss.
    const auto tick = [&](int count) { return clock_.time_of(static_cast<Cycle>(count) * format.divisor); };
    const bool exact = !line_.sound(tick(votes ? kVoters : 1));
    const Time own_flight = exact ? clock_.time_of(bit_cycles * static_cast<Cycle>(1 + format.data_bits)) : 0;
    Cycle first = 0;
    for (;;) {
        const std::optional<Time> edge = line_.falling_edge(listening_from_);
        if (!edge) {
            line_.forget_before(listening_from_);
            return std::nullopt;
        }
        // The edge is seen at the next tick of the 16x clock; bit centres are 8, 24, 40, ... ticks later (of
        // the 4x clock: 2, 6, 10, ...).
        const Cycle seen = clock_.first_cycle_at(*edge);
        const Cycle late = seen > format.phase ? (seen - format.phase) % format.divisor : 0;
        const Cycle seen_tick = seen + (late ? format.divisor - late : 0);
        if (exact) {
            if (may_change(clock_.time_of(seen_tick), now, own_flight, true)) return std::nullopt;
            const Cycle before = seen_tick - std::min<Cycle>(seen_tick, format.divisor);
            if (line_.level(clock_.time_of(seen_tick)) || !line_.level(clock_.time_of(before))) {
                listening_from_ = *edge + 1;  // between two samples
                continue;
            }
        }
        first = seen_tick + format.ticks / 2 * format.divisor;
        if (exact && may_change(clock_.time_of(first + (votes ? format.divisor : 0)), now, own_flight, true))
            return std::nullopt;
        if (!sample(format, first, exact)) break;
        listening_from_ = clock_.time_of(first);  // too short for a start bit
    }
    const auto centre = [&](int bit) { return first + bit_cycles * static_cast<Cycle>(bit); };
    const auto high = [&](int bit) { return sample(format, centre(bit), exact); };
    const int stop = 1 + format.data_bits + (format.parity ? 1 : 0);
    const int last_stop = stop + format.stop_bits - 1;
    if (may_change(clock_.time_of(centre(last_stop) + (exact && votes ? format.divisor : 0)), now, own_flight,
                   exact))
        return std::nullopt;

    Character character;
    character.done = centre(last_stop);
    int ones = 0;
    for (int i = 0; i < format.data_bits; ++i) {
        const bool one = high(1 + i);
        character.data = static_cast<std::uint16_t>(character.data | (one ? 1u << i : 0u));
        ones += one;
    }
    if (format.parity) {
        ones += high(stop - 1);
        character.parity_error = (ones % 2 == 1) != (format.parity == 1);
    }
    const Time stop_time = clock_.time_of(character.done);
    for (int i = stop; i <= last_stop; ++i)
        character.framing_error = character.framing_error || !high(i);
    // After a framing error, a break above all, the line must rest before a start bit counts.
    listening_from_ = character.framing_error ? line_.first_high(stop_time) : stop_time;
    // No receiver has two characters sooner after each other: the next start bit begins at the stop bit's
    // middle.
    const Cycle shortest = format.ticks / 2 * format.divisor + bit_cycles * static_cast<Cycle>(last_stop);
    if (newest_ > 0) character.done = std::max(character.done, newest_ + shortest);
    newest_ = std::max(character.done, now);
    return character;
}

}  // namespace puckloop::chip
