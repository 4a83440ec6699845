#include "emu/avr/peripherals/serial/clocked_usart.h"

#include "emu/avr/peripherals/shared_registers.h"

#include "protocols/serial/uart_sampling.h"

#include <bit>

namespace puckloop::avr {

namespace {
constexpr std::uint8_t kSpiEdges = 16;
constexpr PinUser kUser = PinUser::Serial;
}  // namespace

ClockedUsart::ClockedUsart(const Surroundings& around, const cosim::ClockDomain& clock, Ports& ports,
                           Owner& owner, Pin xck, Pin rxd, Pin txd)
    : around_(around),
      clock_(clock),
      ports_(ports),
      owner_(owner),
      xck_(xck),
      rxd_(rxd),
      txd_(txd),
      slot_(around.events.add(this, &due)) {
    ports_.listen(this, &pins_changed);
    ports_.listen_drivers(this, &drivers_changed);
}

void ClockedUsart::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

void ClockedUsart::configure(const Format& format) {
    const bool master = format.mode == Mode::Synchronous && ports_.output(xck_);
    const bool same = format == state_.format && master == state_.master;
    if (same) return;
    const bool same_mode = format.mode == state_.format.mode;
    const bool new_clock = master != state_.master || format.half != state_.format.half;
    state_.format = format;
    state_.master = master;
    if (!same_mode) {
        state_.busy = state_.in_frame = false;
        state_.left = 0;
        around_.events.cancel(slot_);
    }
    if (format.mode == Mode::Off) return ports_.release_value(xck_, kUser);
    if (format.mode == Mode::SpiMaster) {
        state_.level = format.polarity;
        return ports_.override_value(xck_, state_.level, kUser);
    }
    if (same_mode && !new_clock) return;
    state_.level = false;
    state_.origin = around_.now + 1;
    ports_.override_value(xck_, false, kUser);
    around_.events.schedule(slot_, master ? state_.origin + format.half : kNoCycle);
}

std::optional<cosim::UartFrame> ClockedUsart::begun() const {
    if (!state_.started || state_.left < state_.format.stop_bits) return std::nullopt;
    return state_.frame;
}

std::optional<Cycle> ClockedUsart::sampling_phase() const {
    if (!state_.master) return std::nullopt;
    return state_.origin + (state_.format.polarity ? state_.format.half : 0);
}

void ClockedUsart::kick() {
    if (state_.busy) return;
    const std::optional<std::uint16_t> word = owner_.take_word();
    if (!word) return;
    load(*word);
    // A clock to the shift register and one more before XCK moves (docs/measured_silicon.md).
    constexpr Cycle kToFirstClock = 2;
    if (state_.format.mode == Mode::SpiMaster) begin_spi(around_.now + kToFirstClock);
}

// The bits of a word in the order in which they go out.
void ClockedUsart::load(std::uint16_t word) {
    const Format& format = state_.format;
    state_.busy = true;
    state_.started = false;
    state_.shift = static_cast<std::uint8_t>(word);
    cosim::UartFrame& frame = state_.frame;
    frame = {};
    frame.data_bits = format.data_bits;
    frame.parity = format.parity;
    frame.stop_bits = format.stop_bits;
    frame.data = static_cast<std::uint16_t>(word & ((1u << format.data_bits) - 1u));
    const bool odd_ones = std::popcount(frame.data) % 2;
    frame.parity_bit = frame.parity == 2 ? odd_ones : frame.parity == 1 ? !odd_ones : 0;
    std::uint32_t bits = static_cast<std::uint32_t>(frame.data) << 1;  // the start bit is low
    int count = 1 + format.data_bits;
    if (format.parity) bits |= static_cast<std::uint32_t>(frame.parity_bit) << count++;
    for (int i = 0; i < format.stop_bits; ++i)
        bits |= 1u << count++;
    state_.out = static_cast<std::uint16_t>(bits);
    state_.left = static_cast<std::uint8_t>(count);
}

// ---- synchronous frames

void ClockedUsart::clock_edge(Cycle now, bool rising) {
    if (rising != state_.format.polarity)
        change(now);
    else
        sample(now);
}

// The line takes its next bit.
void ClockedUsart::change(Cycle now) {
    if (!state_.busy) return;
    if (state_.left == 0) {  // the last stop bit ends
        state_.busy = state_.started = false;
        const std::optional<std::uint16_t> word = owner_.take_word();
        if (!word) return owner_.all_out();
        load(*word);
    }
    cosim::UartFrame& frame = state_.frame;
    if (!state_.started) {
        state_.started = true;
        frame.start = clock_.time_of(now);
    }
    ports_.override_value(txd_, state_.out & 1u, kUser);
    state_.out = static_cast<std::uint16_t>(state_.out >> 1);
    if (--state_.left + 1 != frame.stop_bits) return;
    const int bits = protocols::bits_before_stop(frame);
    frame.bit_period = (clock_.time_of(now) - frame.start + bits - 1) / bits;
    owner_.frame_out(frame);
}

void ClockedUsart::sample(Cycle now) {
    if (!owner_.listens()) return;
    const bool level = ports_.level(rxd_);
    if (!state_.in_frame) {
        state_.in_frame = !level;
        state_.count = 0;
        state_.in = 0;
        state_.ones_odd = state_.parity_error = false;
        return;
    }
    const Format& format = state_.format;
    const int place = state_.count++;
    if (place < format.data_bits) {
        state_.in = static_cast<std::uint16_t>(state_.in | static_cast<unsigned>(level) << place);
        state_.ones_odd ^= level;
    } else if (format.parity && place == format.data_bits) {
        state_.parity_error = (state_.ones_odd != level) != (format.parity == 1);
    } else {
        state_.in_frame = false;
        owner_.word_in(now, state_.in, !level, state_.parity_error);
    }
}

// ---- SPI master

void ClockedUsart::begin_spi(Cycle now) {
    state_.edges = 0;
    if (!state_.format.late) show_bit();
    around_.events.schedule(slot_, now + state_.format.half);
}

void ClockedUsart::show_bit() {
    ports_.override_value(txd_, state_.shift & (state_.format.lowest_first ? kLowest : kHighest), kUser);
}

// As the SPI's (spi.cpp): bits are sampled at leading edges and change at trailing ones, or the other way
// round.
void ClockedUsart::spi_edge(Cycle now) {
    const bool leading = state_.edges % 2 == 0;
    const bool samples = leading != state_.format.late;
    const bool lowest_first = state_.format.lowest_first;
    ++state_.edges;
    if (samples) state_.incoming = ports_.level(rxd_);
    state_.level = leading != state_.format.polarity;
    ports_.override_value(xck_, state_.level, kUser);
    if (state_.edges != kSpiEdges) around_.events.schedule(slot_, now + state_.format.half);
    if (leading) {
        if (!samples) show_bit();
        return;
    }
    const std::uint8_t in = state_.incoming ? (lowest_first ? kHighest : kLowest) : std::uint8_t{0};
    state_.shift = static_cast<std::uint8_t>((lowest_first ? state_.shift >> 1 : state_.shift << 1) | in);
    if (state_.edges != kSpiEdges) {
        if (!samples) show_bit();
        return;
    }
    state_.busy = false;
    owner_.word_out();
    if (owner_.listens()) owner_.word_in(now, state_.shift, false, false);
    const std::optional<std::uint16_t> word = owner_.take_word();
    if (!word) return owner_.all_out();
    load(*word);
    begin_spi(now);
}

// ---- the clock

void ClockedUsart::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<ClockedUsart*>(owner);
    State& st = self.state_;
    if (st.format.mode == Mode::SpiMaster) return self.spi_edge(cycle);
    st.level = !st.level;
    self.around_.events.schedule(self.slot_, cycle + st.format.half);
    const bool samples = st.level == st.format.polarity;
    if (samples) self.clock_edge(cycle, st.level);  // before whoever is outside answers the edge
    self.ports_.override_value(self.xck_, st.level, kUser);
    if (!samples) self.clock_edge(cycle, st.level);
}

void ClockedUsart::pins_changed(void* owner, PortLetter port, std::uint8_t before, std::uint8_t after,
                                Cycle now) {
    auto& self = *static_cast<ClockedUsart*>(owner);
    if (self.state_.format.mode != Mode::Synchronous || self.state_.master || port != self.xck_.port) return;
    if ((before ^ after) & self.xck_.mask()) self.clock_edge(now, after & self.xck_.mask());
}

void ClockedUsart::drivers_changed(void* owner, PortLetter port) {
    auto& self = *static_cast<ClockedUsart*>(owner);
    if (port == self.xck_.port && self.state_.format.mode == Mode::Synchronous)
        self.configure(self.state_.format);
}

}  // namespace puckloop::avr
