// What is between a 33FJ's UART and its line: polarity, IrDA's coding, flow control by UxCTS and UxRTS.
// Source: DS70286, registers UxMODE and UxSTA; family reference manual on the UART, DS70188, sections 17.9
// (loopback), 17.12 and 17.13.

#include "emu/dspic/devices/register_bits.h"
#include "emu/dspic/peripherals/serial/uart.h"

#include "protocols/serial/uart_line.h"
#include "protocols/serial/uart_sampling.h"

namespace puckloop::dspic {

namespace {

constexpr RegisterBits kUxMODE{"U?MODE"};
constexpr RegisterBits kUxSTA{"U?STA"};

enum Uen : unsigned { kNone, kRts, kRtsAndCts, kClock };

}  // namespace

// ---- the transmitter's side

bool Uart::infrared() const {
    return setup_.family_33f && (mode() & kUxMODE["IREN"]) && !(mode() & kUxMODE["BRGH"]);
}

// UTXINV: without IREN 1 is low at rest, with IREN 1 is high.
bool Uart::idles_low() const {
    if (!setup_.family_33f) return false;
    return ((sta() & kUxSTA["UTXINV"]) != 0) != infrared();
}

// Without a transmitter the line is released, and high.
void Uart::update_rest(Cycle at) {
    const bool low = enabled() && (sta() & kUxSTA["UTXEN"]) && idles_low();
    if (low == (line_.rests_low != line_.level.has_value())) return;
    if (line_.level) {  // back before anybody heard of it
        line_.level.reset();
        return around_.events.cancel(level_slot_);
    }
    const Cycle bit = static_cast<Cycle>(ticks_per_bit()) * divisor();
    const cosim::Time start = clock_.time_of(at);
    cosim::UartFrame level = protocols::line_level(!low, start, 1);
    const int bits = protocols::bits_before_stop(level);
    const Cycle due = at + bit * static_cast<Cycle>(bits);
    level.bit_period = (clock_.time_of(due) - start + bits - 1) / bits;
    line_.level = level;
    around_.events.schedule(level_slot_, due);
}

void Uart::level_due(void* owner, Cycle due) {
    Uart& self = *static_cast<Uart*>(owner);
    const cosim::UartFrame level = *self.line_.level;
    self.line_.level.reset();
    self.line_.rests_low = !self.line_.rests_low;
    if (!(self.mode() & kUxMODE["LPBACK"])) return self.pins_.uart_sent(self.setup_.unit, level);
    self.take_from_line(level, due);
    self.sample(due);
}

// ---- the receiver's side

void Uart::update_polarity(Cycle at) {
    const bool turned = mode() & kUxMODE["URXINV"], decodes = infrared();
    if (turned == line_.turned && decodes == line_.decodes) return;
    const bool was_low = line_.decodes ? line_.infrared.rests_low() : !receiver_.level(at);
    const bool low = was_low != (turned != line_.turned);
    line_.turned = turned;
    line_.decodes = decodes;
    line_.infrared.reset(low);
    receiver_.set_rest(decodes || !low, at);
}

// As the receiver sees the frame behind URXINV and the decoder.
void Uart::take_from_line(const cosim::UartFrame& frame, Cycle at) {
    cosim::UartFrame seen = frame;
    if (line_.turned) seen.line ^= cosim::kLineInverted | cosim::kLineRestsLow;
    const auto take = [&](const cosim::UartFrame& piece) {
        const bool special = (mode() & (kUxMODE["ABAUD"] | kUxMODE["WAKE"])) && !(mode() & kUxMODE["LPBACK"]);
        if (special && consumed(piece, at)) return;
        if (!state_.held) receiver_.frame(piece);
    };
    if (!infrared()) return take(seen);
    const auto cycles = static_cast<Cycle>(ticks_per_bit()) * divisor();
    const cosim::Time bit = clock_.time_of(state_.phase + cycles) - clock_.time_of(state_.phase);
    for (const cosim::UartFrame& piece : line_.infrared.add(seen, bit))
        take(piece);
}

// ---- flow control

/// UEN while the module is on; 0 on a 30F, which has none.
unsigned Uart::flow_pins() const {
    return setup_.family_33f && enabled() ? kUxMODE["UEN"].of(mode()) : unsigned{kNone};
}

// Looped back, UxCTS is the module's own UxRTS.
bool Uart::cts_holds() const {
    if (flow_pins() != kRtsAndCts) return false;
    if (mode() & kUxMODE["LPBACK"]) return !rts_low();
    return ports_.level(setup_.flow_port, setup_.cts_pin);
}

void Uart::cts_changed(void* owner, bool level, Cycle at) {
    Uart& self = *static_cast<Uart*>(owner);
    if (level || at == kNoCycle || self.flow_pins() != kRtsAndCts) return;
    if ((self.sta() & kUxSTA["UTXEN"]) && !self.state_.shifting) self.begin_frame(at);
}

// RTSMD 1, simplex: something is to be sent. 0, flow control: there is room for a character.
bool Uart::rts_low() const {
    if (mode() & kUxMODE["RTSMD"]) return !(sta() & kUxSTA["TRMT"]);
    return !state_.receive.full() && !(sta() & kUxSTA["OERR"]);
}

void Uart::show_rts(Cycle when) {
    const std::uint16_t rts = bit(setup_.rts_pin), cts = bit(setup_.cts_pin);
    switch (flow_pins()) {
    case kNone:
        if (ports_.taken_over(setup_.flow_port) & (rts | cts)) ports_.release(setup_.flow_port, rts | cts);
        return;
    case kRtsAndCts:
        ports_.attend(setup_.flow_port, setup_.cts_pin);
        return ports_.take_over(setup_.flow_port, rts | cts, rts, rts_low() ? 0 : rts, when);
    case kRts:
        ports_.take_over(setup_.flow_port, rts, rts, rts_low() ? 0 : rts, when);
        break;
    case kClock:
        ports_.take_over(setup_.flow_port, rts, rts, 0, when);
        break;
    }
    if (ports_.taken_over(setup_.flow_port) & cts) ports_.release(setup_.flow_port, cts);
}

}  // namespace puckloop::dspic
