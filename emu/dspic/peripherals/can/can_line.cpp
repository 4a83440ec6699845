#include "emu/dspic/peripherals/can/can_line.h"

#include "emu/dspic/peripherals/can/can_registers.h"

#include <algorithm>
#include <iterator>

namespace puckloop::dspic {

using namespace can;

namespace {

constexpr Cycle kIdleBits = 11;  // recessive bits that show an idle bus
constexpr Cycle kIntermission = 3;
constexpr unsigned kWarning = 96, kPassive = 128, kBusOff = 256;
constexpr unsigned kLimits[] = {kWarning, kPassive, kBusOff};
constexpr unsigned kErrorStep = 8;
constexpr std::uint16_t kFlags = 0xFF;  // of CxINTF that interrupt

}  // namespace

CanLine::CanLine(const Surroundings& around, const Place& place, const cosim::ClockDomain& clock,
                 Ports& ports, Pins& pins)
    : around_(around),
      place_(place),
      clock_(clock),
      ports_(ports),
      pins_(pins),
      slot_(around.events.add(this, due)),
      wired_(pins.can_wired(place.unit)) {}

void CanLine::reset_line() {
    const Role role = state_.role;
    state_ = {};
    state_.role = role;
    take_role(around_.now);
    around_.events.cancel(slot_);
}

CanLine::Mode CanLine::mode() const {
    return static_cast<Mode>(kCTRL["OPMODE"].of(reg(place_.ctrl)));
}

// A bit is 1 + PRSEG + SEG1PH + SEG2PH quanta, sampled before SEG2PH.
CanLine::Quanta CanLine::bit_quanta() const {
    const unsigned cfg2 = reg(place_.cfg2);
    const unsigned first = kCFG2["SEG1PH"].of(cfg2) + 1;
    const unsigned second = cfg2 & kCFG2["SEG2PHTS"] ? kCFG2["SEG2PH"].of(cfg2) + 1 : std::max(first, 2u);
    return {1 + kCFG2["PRSEG"].of(cfg2) + 1 + first + second, second};
}

// A quantum is 2 (BRP + 1) master clocks.
Cycle CanLine::bit_quarters() const {
    const unsigned clocks = bit_quanta().all * 2 * (kCFG1["BRP"].of(reg(place_.cfg1)) + 1);
    return clocks * (reg(place_.ctrl) & kCTRL["CANCKS"] ? place_.clock_quarters_set : place_.clock_quarters);
}

void CanLine::plan() {
    around_.events.schedule(slot_, std::min(state_.mode_due, state_.frame_due));
}

void CanLine::due(void* owner, Cycle due) {
    CanLine& self = *static_cast<CanLine*>(owner);
    State& state = self.state_;
    if (state.frame_due <= due) {
        state.frame_due = kNoCycle;
        if (state.sending == kNobody)
            self.send(due);
        else
            self.end_frame(due);
    }
    if (state.mode_due <= due) {
        const bool sends = state.sending != kNobody;
        state.mode_due = sends ? state.frame_due : kNoCycle;
        if (!sends) self.enter_mode(due);
    }
    self.plan();
}

void CanLine::hold(bool on) {
    if (state_.held == on) return;
    state_.held = on;
    if (on && state_.sending != kNobody) {  // half a frame: it is sent again
        state_.sending = kNobody;
        state_.frame_due = kNoCycle;
    }
    take_role(around_.now);
    if (!on) look_for_frame(around_.now);
    plan();
}

// ---- modes

void CanLine::mode_written() {
    const Cycle at = around_.now + 1;
    if (reg(place_.ctrl) & kCTRL["ABAT"]) {
        for (int buffer = 0; buffer < place_.transmitters; ++buffer)
            if (asks(buffer)) abort(buffer);
        assign(reg(place_.ctrl), kCTRL["ABAT"], false);
    }
    request_mode(at);
    look_for_frame(at);
    plan();
}

void CanLine::request_mode(Cycle at) {
    const auto wanted = static_cast<Mode>(kCTRL["REQOP"].of(reg(place_.ctrl)));
    if (wanted == mode()) {
        state_.mode_due = kNoCycle;
        return;
    }
    const bool listens = wanted == Mode::Normal || wanted == Mode::ListenOnly || wanted == Mode::ListenAll;
    state_.mode_due = at + (listens ? bits(kIdleBits) : 0);
    if (state_.sending != kNobody) state_.mode_due = std::max(state_.mode_due, state_.frame_due);
    if (state_.sending != kNobody && on_bus()) withdraw(at);  // the bus's answer asks for the mode again
}

void CanLine::enter_mode(Cycle at) {
    std::uint16_t& ctrl = reg(place_.ctrl);
    const unsigned wanted = kCTRL["REQOP"].of(ctrl);
    ctrl = static_cast<std::uint16_t>((ctrl & ~kCTRL["OPMODE"]) | wanted << 5);
    if (mode() == Mode::Configuration) {
        state_.errors = 0;
        reg(place_.ec) = 0;
        show_errors();
    }
    take_role(at);
    take_over_pins(at);
    look_for_frame(at);
}

void CanLine::take_over_pins(Cycle at) {
    const std::uint16_t rx = bit(place_.rx), tx = bit(place_.tx);
    const bool off = mode() == Mode::Configuration || mode() == Mode::Disable;
    if (off)
        ports_.release(place_.port, rx | tx);
    else
        ports_.take_over(place_.port, rx | tx, tx, tx, at);
}

// ---- transmission

void CanLine::change_control(int buffer, std::uint8_t clear, std::uint8_t set) {
    set_control(buffer, static_cast<std::uint8_t>((control_of(buffer) & ~clear) | set));
}

void CanLine::control_written(int buffer, bool was_asked) {
    const Cycle at = around_.now + 1;
    if (!was_asked && asks(buffer)) {
        change_control(buffer, kTxAbt | kTxLarb | kTxErr, 0);
    } else if (was_asked && !asks(buffer)) {
        if (state_.sending == buffer) change_control(buffer, 0, kTxReq);
        abort(buffer);
    }
    look_for_frame(at);
    plan();
}

// Plans the next frame if one is asked for and may be sent.
void CanLine::look_for_frame(Cycle at) {
    if (on_bus()) return offer(at);
    if (state_.sending != kNobody || state_.held) return;
    state_.frame_due = kNoCycle;
    if (state_.mode_due != kNoCycle) return;
    if (mode() != Mode::Normal && mode() != Mode::Loopback) return;
    for (int buffer = 0; buffer < place_.transmitters; ++buffer)
        if (asks(buffer)) state_.frame_due = std::max(at, state_.bus_free);
}

// The highest TXPRI first, the highest buffer among equals; -1: none asks.
int CanLine::best_buffer() const {
    int best = -1;
    unsigned priority = 0;
    for (int buffer = 0; buffer < place_.transmitters; ++buffer) {
        const unsigned wants = control_of(buffer) & kTxPri;
        if (!asks(buffer) || (best >= 0 && wants < priority)) continue;
        best = buffer;
        priority = wants;
    }
    return best;
}

void CanLine::send(Cycle at) {
    const int best = best_buffer();
    if (best < 0) return;
    state_.sending = static_cast<std::uint8_t>(best);
    state_.frame = frame_of(best, at);
    state_.frame_due = at + bits(static_cast<Cycle>(can_bits(state_.frame)));
}

/// In loopback it comes back; alone, nobody acknowledges, for which an error passive sender is not punished.
void CanLine::end_frame(Cycle at) {
    const int buffer = state_.sending;
    const CanFrame frame = state_.frame;
    state_.sending = kNobody;
    state_.bus_free = at + bits(kIntermission);
    if (mode() == Mode::Loopback) {
        change_control(buffer, kTxErr | kTxReq, 0);
        was_sent(buffer, at);
        deliver(frame, at);
    } else {
        if (state_.errors < kPassive) count_errors(state_.errors + kErrorStep, 0, at);
        change_control(buffer, 0, kTxErr);
    }
    look_for_frame(at);
}

void CanLine::abort(int buffer) {
    if (state_.sending == buffer && on_bus()) {
        state_.aborting |= static_cast<std::uint8_t>(1u << buffer);
        return withdraw(around_.now + 1);
    }
    if (state_.sending == buffer) return;  // what is on the wire goes on
    change_control(buffer, kTxReq, kTxAbt);
}

void CanLine::count_errors(unsigned transmit, unsigned receive, Cycle at) {
    const unsigned sent_before = state_.errors, received_before = reg(place_.ec) & 0xFFu;
    state_.errors = static_cast<std::uint16_t>(transmit);
    reg(place_.ec) = static_cast<std::uint16_t>(receive);
    show_errors();
    const auto crossed = [](unsigned before, unsigned now) {
        return std::any_of(std::begin(kLimits), std::end(kLimits),
                           [&](unsigned limit) { return before < limit && now >= limit; });
    };
    if (crossed(sent_before, transmit) || crossed(received_before, receive)) set_flags(kErrIf, at);
}

void CanLine::show_errors() {
    std::uint16_t& intf = reg(place_.intf);
    const unsigned received = reg(place_.ec) & 0xFFu;
    reg(place_.ec) = static_cast<std::uint16_t>((state_.errors & 0xFFu) << 8 | received);
    assign(intf, kTxWarn, state_.errors >= kWarning);
    assign(intf, kTxBp, state_.errors >= kPassive && state_.errors < kBusOff);
    assign(intf, kTxBo, state_.errors >= kBusOff);
    assign(intf, kRxWarn, received >= kWarning);
    assign(intf, kRxBp, received >= kPassive);
    assign(intf, kEwarn, (intf & (kTxWarn | kRxWarn)) != 0);
}

// ---- interrupts

void CanLine::set_flags(std::uint16_t flags, Cycle at) {
    reg(place_.intf) |= flags;
    show_code();
    if (flags & reg(place_.inte)) around_.interrupts.raise(place_.irq, at);
}

void CanLine::interrupts_written(std::uint16_t address, std::uint16_t value, std::uint16_t mask,
                                 std::uint16_t clearable) {
    if (address == place_.ec) return;  // read only
    std::uint16_t& stored = reg(address);
    const unsigned before = reg(place_.intf) & reg(place_.inte);
    if (address == place_.intf)
        stored = static_cast<std::uint16_t>(stored & (value | ~(mask & clearable)));
    else
        around_.sfr.store(address, value, mask);
    show_code();
    if (reg(place_.intf) & reg(place_.inte) & ~before & kFlags)
        around_.interrupts.raise(place_.irq, around_.now);
}

}  // namespace puckloop::dspic
