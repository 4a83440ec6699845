#include "emu/dspic/peripherals/serial/uart.h"

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/peripherals/timing/input_capture.h"

#include "protocols/serial/uart_sampling.h"

#include <algorithm>
#include <bit>

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kUxMODE{"U?MODE"};
constexpr RegisterBits kUxSTA{"U?STA"};
constexpr std::uint16_t kStaWritable =
    kUxSTA["UTXISEL"] | kUxSTA["UTXBRK"] | kUxSTA["UTXEN"] | kUxSTA["URXISEL"] | kUxSTA["ADDEN"];

constexpr std::uint16_t kNinthBit = bit(8);
constexpr std::uint32_t kTicksPerBit = 16;
constexpr std::uint32_t kTicksPerBitHigh = 4;

}  // namespace

Uart::Uart(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock, Ports& ports,
           Pins& pins)
    : around_(around),
      setup_(setup),
      clock_(clock),
      ports_(ports),
      pins_(pins),
      receiver_(clock),
      transmit_slot_(around.events.add(this, transmit_due)),
      receive_slot_(around.events.add(this, receive_due)) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup_.mode + offset); };
    around_.sfr.hook(at(0), this, nullptr, write_mode);
    around_.sfr.hook(at(2), this, nullptr, write_sta);
    around_.sfr.hook(at(4), this, nullptr, write_txreg);
    around_.sfr.hook(at(6), this, read_rxreg, write_rxreg);
    around_.sfr.hook(at(8), this, nullptr, write_brg);
    if (!setup_.family_33f) return;
    level_slot_ = around.events.add(this, level_due);
    ports_.listen(setup_.flow_port, setup_.cts_pin, this, cts_changed);
}

void Uart::reset() {
    state_ = {};
    state_.phase = around_.now;
    around_.events.cancel(transmit_slot_);
    around_.events.cancel(receive_slot_);
    if (!setup_.family_33f) return;
    update_rest(around_.now);
    update_polarity(around_.now);
}

bool Uart::enabled() const {
    return mode() & kUxMODE["UARTEN"];
}

std::optional<cosim::UartFrame> Uart::begun() const {
    const bool shifting = state_.shifting && !state_.stop_begun;
    if (!line_.level) return shifting ? std::optional(state_.frame) : std::nullopt;
    const bool frame_first =
        shifting && protocols::stop_bit_start(state_.frame) < protocols::stop_bit_start(*line_.level);
    return frame_first ? state_.frame : *line_.level;
}

std::uint32_t Uart::ticks_per_bit() const {
    return setup_.family_33f && (mode() & kUxMODE["BRGH"]) ? kTicksPerBitHigh : kTicksPerBit;
}

std::uint16_t Uart::writable_sta() const {
    return setup_.family_33f ? kStaWritable | kUxSTA["UTXINV"] | kUxSTA["UTXISEL0"] : kStaWritable;
}

// The word that moves to the shift register now raises UxTXIF. 30F: UTXISEL 0 each one, 1 the one that
// empties the FIFO. 33FJ: 00 each one, 10 the one that empties the FIFO, 01 none (the end of the last frame).
bool Uart::transfer_interrupts() const {
    if (setup_.family_33f && (sta() & kUxSTA["UTXISEL0"])) return false;
    return !(sta() & kUxSTA["UTXISEL"]) || state_.transmit.count == 0;
}

// UARTEN = 0: both FIFOs, both shift registers.
void Uart::clear() {
    stop_transmitter();
    state_.receive = {};
    state_.sampled.reset();
    around_.events.cancel(receive_slot_);
    sta() = static_cast<std::uint16_t>(
        (sta() & ~(kUxSTA["OERR"] | kUxSTA["URXDA"] | kUxSTA["FERR"] | kUxSTA["PERR"])) | kUxSTA["RIDLE"]);
}

void Uart::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    if (!enabled()) return;
    if (on) {
        state_.shifting = false;
        state_.sampled.reset();
        around_.events.cancel(transmit_slot_);
        around_.events.cancel(receive_slot_);
        sta() |= kUxSTA["RIDLE"];
    } else {
        receiver_.start(around_.now);
        if (sta() & kUxSTA["UTXEN"]) begin_frame(around_.now);
    }
    show_transmitter();
}

void Uart::take_over_pins() {
    const std::uint16_t rx = bit(setup_.rx_pin);
    const std::uint16_t tx = bit(setup_.tx_pin);
    if (!enabled()) {
        ports_.release(setup_.port, rx | tx);
    } else if (sta() & kUxSTA["UTXEN"]) {
        const bool low = setup_.family_33f ? idles_low() : (sta() & kUxSTA["UTXBRK"]) != 0;
        ports_.take_over(setup_.port, rx | tx, tx, low ? 0 : tx);
    } else {
        ports_.take_over(setup_.port, rx, 0, 0);
        ports_.release(setup_.port, tx);
    }
    if (setup_.family_33f) update_rest(around_.now + 1);
}

// ---- transmitter

void Uart::show_transmitter() {
    assign(sta(), kUxSTA["UTXBF"], state_.transmit.full());
    assign(sta(), kUxSTA["TRMT"], !state_.shifting && state_.transmit.count == 0);
    if (flow_pins() != 0) show_rts(around_.now + 1);
}

void Uart::stop_transmitter() {
    state_.transmit = {};
    state_.shifting = false;
    around_.events.cancel(transmit_slot_);
    show_transmitter();
}

// Moves the next word into the empty shift register; its start bit begins at a tick at or after `from`.
void Uart::begin_frame(Cycle from) {
    const bool is_break = sta() & kUxSTA["UTXBRK"];
    if (state_.held) return;
    if ((setup_.family_33f || !is_break) && state_.transmit.count == 0) return;
    if (cts_holds()) return;
    const Cycle late = (from - state_.phase) % divisor();
    const Cycle start = from + (late ? divisor() - late : 0);

    cosim::UartFrame& frame = state_.frame;
    frame = {};
    const unsigned pdsel = kUxMODE["PDSEL"].of(mode());
    frame.data_bits = pdsel == 3 ? 9 : 8;
    frame.parity = pdsel == 1 ? 2 : pdsel == 2 ? 1 : 0;
    frame.stop_bits = mode() & kUxMODE["STSEL"] ? 2 : 1;
    frame.is_break = is_break;
    if (idles_low()) frame.line = cosim::kLineInverted | cosim::kLineRestsLow;
    if (infrared()) protocols::set_infrared(frame);
    if (is_break && setup_.family_33f) {  // the word written is a dummy
        state_.transmit.pop();
        assign(sta(), kUxSTA["UTXBRK"], false);
        if (transfer_interrupts()) around_.interrupts.raise(setup_.tx_irq, from);
    }
    if (!is_break) {
        const std::uint16_t mask = static_cast<std::uint16_t>((1u << frame.data_bits) - 1u);
        frame.data = state_.transmit.top() & mask;
        state_.transmit.pop();
        const bool odd_ones = std::popcount(frame.data) % 2;
        frame.parity_bit = frame.parity == 2 ? odd_ones : frame.parity == 1 ? !odd_ones : 0;
        if (transfer_interrupts()) around_.interrupts.raise(setup_.tx_irq, from);
    }
    const Cycle bit_cycles = static_cast<Cycle>(ticks_per_bit()) * divisor();
    const int bits = protocols::bits_before_stop(frame);
    const Cycle stop = start + bit_cycles * static_cast<Cycle>(bits);
    frame.start = clock_.time_of(start);
    // Rounded up, so that the stamp of the stop bit never lies before the event that hands the frame out.
    frame.bit_period = (clock_.time_of(stop) - frame.start + bits - 1) / bits;
    state_.frame_end = stop + bit_cycles * frame.stop_bits;
    state_.shifting = true;
    state_.stop_begun = false;
    show_transmitter();
    around_.events.schedule(transmit_slot_, stop);
}

void Uart::transmit_due(void* owner, Cycle due) {
    Uart& self = *static_cast<Uart*>(owner);
    if (!self.state_.stop_begun) {  // the stop bit begins: everybody can know the frame now
        self.state_.stop_begun = true;
        self.around_.events.schedule(self.transmit_slot_, self.state_.frame_end);
        ++self.counters_.sent;
        const cosim::UartFrame frame = self.state_.frame;
        if (self.mode() & kUxMODE["LPBACK"]) {
            self.take_from_line(frame, due);
            self.sample(due);
        } else {
            self.pins_.uart_sent(self.setup_.unit, frame);
        }
        return;
    }
    self.state_.shifting = false;
    self.show_transmitter();
    const bool at_end = self.setup_.family_33f && (self.sta() & kUxSTA["UTXISEL0"]);
    if (at_end && self.state_.transmit.count == 0) self.around_.interrupts.raise(self.setup_.tx_irq, due);
    self.begin_frame(due);
}

void Uart::write_txreg(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Uart& self = *static_cast<Uart*>(owner);
    self.around_.sfr.store(address, value, mask);
    if (!self.enabled() || mask == 0xFF00 || self.state_.transmit.full()) return;
    self.state_.transmit.push(mask == 0xFFFF ? value & 0x1FF : value & 0xFF);
    self.show_transmitter();
    if ((self.sta() & kUxSTA["UTXEN"]) && !self.state_.shifting) self.begin_frame(self.around_.now + 1);
}

// ---- receiver

UartReceiver::Format Uart::format() const {
    const unsigned pdsel = kUxMODE["PDSEL"].of(mode());
    return {divisor(),    pdsel == 3 ? 9 : 8, pdsel == 1 ? 2 : pdsel == 2 ? 1 : 0,
            state_.phase, ticks_per_bit(),    mode() & kUxMODE["STSEL"] ? 2 : 1};
}

void Uart::receive(const cosim::UartFrame& frame, Cycle at) {
    if (enabled() && (mode() & kUxMODE["LPBACK"])) return;
    if (line_.turned || line_.decodes) {
        take_from_line(frame, at);
    } else {
        if ((mode() & (kUxMODE["ABAUD"] | kUxMODE["WAKE"])) && consumed(frame, at)) return;
        if (state_.held) return;
        receiver_.frame(frame);
    }
    if (state_.held) return;
    if (enabled())
        sample(at);
    else
        receiver_.pass(at);
}

// Auto-baud and wake-up. True: the receiver hears nothing of the frame.
bool Uart::consumed(const cosim::UartFrame& frame, Cycle at) {
    if (capture_ && (mode() & kUxMODE["ABAUD"])) capture_->line_frame(setup_.unit, frame, at);
    if (!enabled()) return false;
    if (mode() & kUxMODE["WAKE"] && (state_.held || setup_.family_33f)) {
        around_.interrupts.raise(setup_.rx_irq, at);
        if (setup_.family_33f) assign(mode(), kUxMODE["WAKE"], false);
        return true;
    }
    if (!setup_.family_33f || !(mode() & kUxMODE["ABAUD"]) || state_.held) return false;
    measure(frame);
    return true;
}

// The 33FJ counts from the first rising edge to the fifth: eight bits of 0x55.
void Uart::measure(const cosim::UartFrame& frame) {
    constexpr std::uint16_t kPattern = 0x55;
    constexpr int kBits = 8;
    if (!is_sound(frame) || frame.is_break || frame.data_bits != kBits || frame.parity ||
        frame.data != kPattern)
        return;
    const Cycle first = clock_.first_cycle_at(frame.start + frame.bit_period);
    const Cycle fifth = clock_.first_cycle_at(frame.start + (kBits + 1) * frame.bit_period);
    const Cycle ticks = (fifth - first) / (kBits * ticks_per_bit());
    around_.sfr.raw(static_cast<std::uint16_t>(setup_.mode + 8)) =
        static_cast<std::uint16_t>(ticks > 0 ? ticks - 1 : 0);
    assign(mode(), kUxMODE["ABAUD"], false);
    receiver_.start(fifth);
}

// Takes characters off the line as far as they are complete at `now`, and plans the next one.
void Uart::sample(Cycle now) {
    while (!state_.sampled || state_.sampled->done <= now) {
        if (state_.sampled) {
            const UartReceiver::Character character = *state_.sampled;
            state_.sampled.reset();
            deliver(character, now);
        }
        state_.sampled = receiver_.next(format(), now);
        if (!state_.sampled) break;
    }
    around_.events.schedule(receive_slot_, state_.sampled ? state_.sampled->done : receiver_.ask_again());
    assign(sta(), kUxSTA["RIDLE"], !state_.sampled && receiver_.ask_again() == kNoCycle);
}

void Uart::receive_due(void* owner, Cycle due) {
    static_cast<Uart*>(owner)->sample(due);
}

void Uart::deliver(const UartReceiver::Character& character, Cycle now) {
    ++counters_.received;
    counters_.framing_errors += character.framing_error;
    counters_.parity_errors += character.parity_error;
    if ((sta() & kUxSTA["ADDEN"]) && kUxMODE["PDSEL"].of(mode()) == 3 && !(character.data & kNinthBit))
        return;
    if (sta() & kUxSTA["OERR"]) {
        ++counters_.overruns;
        return;
    }
    if (state_.receive.full()) {
        ++counters_.overruns;
        sta() |= kUxSTA["OERR"];
        if (setup_.family_33f) around_.interrupts.raise(setup_.error_irq, std::max(character.done, now));
        return;
    }
    state_.receive.push({character.data, character.framing_error, character.parity_error});
    show_receiver();
    if (setup_.family_33f && (character.framing_error || character.parity_error))
        around_.interrupts.raise(setup_.error_irq, std::max(character.done, now));
    const unsigned urxisel = kUxSTA["URXISEL"].of(sta());
    if (urxisel < 2 || state_.receive.count == (urxisel == 2 ? 3 : 4))
        around_.interrupts.raise(setup_.rx_irq, std::max(character.done, now));
}

// URXDA, and the top of the FIFO with its errors.
void Uart::show_receiver() {
    const bool any = state_.receive.count > 0;
    assign(sta(), kUxSTA["URXDA"], any);
    assign(sta(), kUxSTA["FERR"], any && state_.receive.top().framing_error);
    assign(sta(), kUxSTA["PERR"], any && state_.receive.top().parity_error);
    if (any) rxreg() = state_.receive.top().data;
    if (flow_pins() != 0) show_rts(around_.now + 1);
}

std::uint16_t Uart::read_rxreg(void* owner, std::uint16_t) {
    Uart& self = *static_cast<Uart*>(owner);
    const std::uint16_t value = self.rxreg();
    if (self.state_.receive.count) {
        self.state_.receive.pop();
        self.show_receiver();
    }
    return value;
}

void Uart::write_rxreg(void*, std::uint16_t, std::uint16_t, std::uint16_t) {}  // read only

// ---- control

void Uart::write_mode(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Uart& self = *static_cast<Uart*>(owner);
    const bool was_enabled = self.enabled();
    self.around_.sfr.store(address, value, mask);
    if (self.capture_) self.capture_->take_line(self.setup_.unit, self.mode() & kUxMODE["ABAUD"]);
    if (self.setup_.family_33f) {
        self.update_polarity(self.around_.now + (was_enabled ? 1 : 0));
        if (was_enabled && self.enabled() && !self.state_.held) self.sample(self.around_.now);
        if (was_enabled || self.enabled()) self.take_over_pins();
        self.show_rts(self.around_.now + 1);
    }
    if (self.enabled() == was_enabled) return;
    if (!self.setup_.family_33f) self.take_over_pins();
    if (self.enabled()) {
        self.state_.phase = self.around_.now + 1;
        self.receiver_.start(self.around_.now + 1);
        if (!self.setup_.family_33f) self.around_.interrupts.raise(self.setup_.tx_irq, self.around_.now);
    } else {
        self.clear();
    }
}

void Uart::write_sta(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Uart& self = *static_cast<Uart*>(owner);
    const std::uint16_t old = self.sta();
    self.around_.sfr.store(address, value, mask & self.writable_sta());
    if ((mask & kUxSTA["OERR"]) && !(value & kUxSTA["OERR"]) &&
        (old & kUxSTA["OERR"])) {  // empties the FIFO and UxRSR
        self.state_.receive = {};
        assign(self.sta(), kUxSTA["OERR"], false);
        self.show_receiver();
    }
    const std::uint16_t changed = old ^ self.sta();
    if (!self.enabled() || !(changed & (kUxSTA["UTXEN"] | kUxSTA["UTXBRK"] | kUxSTA["UTXINV"]))) return;
    self.take_over_pins();
    // 33FJ: the empty transmitter asks for words as soon as it may send.
    if (self.setup_.family_33f && (changed & kUxSTA["UTXEN"]) && (self.sta() & kUxSTA["UTXEN"]))
        self.around_.interrupts.raise(self.setup_.tx_irq, self.around_.now);
    if (!(self.sta() & kUxSTA["UTXEN"]))
        self.stop_transmitter();
    else if (!self.state_.shifting)
        self.begin_frame(self.around_.now + 1);
}

void Uart::write_brg(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Uart& self = *static_cast<Uart*>(owner);
    self.around_.sfr.store(address, value, mask);
    self.state_.phase = self.around_.now + 1;
}

}  // namespace puckloop::dspic
