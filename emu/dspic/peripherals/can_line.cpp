#include "emu/dspic/peripherals/can_line.h"

#include "emu/dspic/peripherals/can_registers.h"

#include <algorithm>

namespace puckloop::dspic {

using namespace can;

namespace {

constexpr Cycle kIdleBits = 11;  // recessive bits that show an idle bus
constexpr Cycle kRecoveries = 128;
constexpr Cycle kIntermission = 3;
constexpr int kAckToEnd = 9;  // bits from the acknowledge slot to the end of the frame
constexpr unsigned kWarning = 96, kPassive = 128, kBusOff = 256;
constexpr unsigned kErrorStep = 8;
constexpr std::uint16_t kFlags = 0xFF;  // of CxINTF that interrupt

}  // namespace

CanLine::CanLine(const Surroundings& around, const Place& place, Ports& ports, Pins& pins)
    : around_(around), place_(place), ports_(ports), pins_(pins), slot_(around.events.add(this, due)) {}

void CanLine::reset_line() {
    state_ = {};
    around_.events.cancel(slot_);
}

CanLine::Mode CanLine::mode() const {
    return static_cast<Mode>(kCTRL["OPMODE"].of(reg(place_.ctrl)));
}

bool CanLine::on_bus() const {
    return mode() == Mode::Normal && state_.errors < kBusOff && !state_.held;
}

// A bit is 1 + PRSEG + SEG1PH + SEG2PH quanta of 2 (BRP + 1) master clocks.
Cycle CanLine::bit_quarters() const {
    const unsigned cfg1 = reg(place_.cfg1), cfg2 = reg(place_.cfg2);
    const unsigned first = kCFG2["SEG1PH"].of(cfg2) + 1;
    const unsigned second = cfg2 & kCFG2["SEG2PHTS"] ? kCFG2["SEG2PH"].of(cfg2) + 1 : std::max(first, 2u);
    const unsigned quanta = 1 + kCFG2["PRSEG"].of(cfg2) + 1 + first + second;
    const unsigned clocks = quanta * 2 * (kCFG1["BRP"].of(cfg1) + 1);
    return clocks * (reg(place_.ctrl) & kCTRL["CANCKS"] ? place_.clock_quarters_set : place_.clock_quarters);
}

void CanLine::plan() {
    around_.events.schedule(slot_, std::min({state_.mode_due, state_.frame_due, state_.recovery}));
}

void CanLine::due(void* owner, Cycle due) {
    CanLine& self = *static_cast<CanLine*>(owner);
    State& state = self.state_;
    if (state.recovery <= due) {
        state.recovery = kNoCycle;
        state.errors = 0;
        self.show_errors();
        self.look_for_frame(due);
    }
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
}

void CanLine::enter_mode(Cycle at) {
    std::uint16_t& ctrl = reg(place_.ctrl);
    const unsigned wanted = kCTRL["REQOP"].of(ctrl);
    ctrl = static_cast<std::uint16_t>((ctrl & ~kCTRL["OPMODE"]) | wanted << 5);
    if (mode() == Mode::Configuration) {
        state_.errors = 0;
        state_.recovery = kNoCycle;
        reg(place_.ec) = 0;
        show_errors();
    }
    lend_pins(at);
    look_for_frame(at);
}

void CanLine::lend_pins(Cycle at) {
    const std::uint16_t rx = bit(place_.rx), tx = bit(place_.tx);
    const bool off = mode() == Mode::Configuration || mode() == Mode::Disable;
    if (off)
        ports_.give_back(place_.port, rx | tx);
    else
        ports_.lend(place_.port, rx | tx, tx, tx, at);
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
    if (state_.sending != kNobody || state_.held) return;
    state_.frame_due = kNoCycle;
    if (state_.mode_due != kNoCycle) return;
    if (!on_bus() && mode() != Mode::Loopback) return;
    for (int buffer = 0; buffer < place_.transmitters; ++buffer)
        if (asks(buffer)) state_.frame_due = std::max(at, state_.bus_free);
}

// The highest TXPRI first, the highest buffer among equals.
void CanLine::send(Cycle at) {
    int best = -1;
    unsigned priority = 0;
    for (int buffer = 0; buffer < place_.transmitters; ++buffer) {
        const unsigned wants = control_of(buffer) & kTxPri;
        if (!asks(buffer) || (best >= 0 && wants < priority)) continue;
        best = buffer;
        priority = wants;
    }
    if (best < 0) return;
    state_.sending = static_cast<std::uint8_t>(best);
    state_.frame = frame_of(best, at);
    state_.frame_due = at + bits(static_cast<Cycle>(can_bits(state_.frame)));
}

void CanLine::end_frame(Cycle at) {
    const int buffer = state_.sending;
    const CanFrame frame = state_.frame;
    const bool loops = mode() == Mode::Loopback;
    const CanOutcome outcome =
        loops ? CanOutcome::Acknowledged : pins_.can_sent(place_.unit, frame, at - bits(kAckToEnd));
    state_.sending = kNobody;
    state_.bus_free = at + bits(kIntermission);
    if (!loops) count_errors(outcome, at);
    const bool well = outcome == CanOutcome::Acknowledged;
    change_control(buffer, well ? kTxErr | kTxReq : 0, well ? 0 : kTxErr);
    if (well) {
        was_sent(buffer, at);
        if (loops) deliver(frame, at);
    }
    look_for_frame(at);
}

void CanLine::abort(int buffer) {
    if (state_.sending == buffer) return;  // what is on the wire goes on
    change_control(buffer, kTxReq, kTxAbt);
}

// An error passive sender is not punished for a missing acknowledge.
void CanLine::count_errors(CanOutcome outcome, Cycle at) {
    const unsigned before = state_.errors;
    if (outcome == CanOutcome::Acknowledged) {
        if (state_.errors > 0) --state_.errors;
    } else if (outcome == CanOutcome::BitError || before < kPassive) {
        state_.errors = static_cast<std::uint16_t>(before + kErrorStep);
    }
    const auto crossed = [&](unsigned limit) { return before < limit && state_.errors >= limit; };
    const bool tells = crossed(kWarning) || crossed(kPassive) || crossed(kBusOff);
    show_errors();
    if (tells) set_flags(kErrIf, at);
    if (crossed(kBusOff)) state_.recovery = at + kRecoveries * bits(kIdleBits);
}

void CanLine::show_errors() {
    std::uint16_t& intf = reg(place_.intf);
    const unsigned received = reg(place_.ec) & 0xFFu;
    reg(place_.ec) = static_cast<std::uint16_t>((state_.errors & 0xFFu) << 8 | received);
    assign(intf, kTxWarn, state_.errors >= kWarning);
    assign(intf, kTxBp, state_.errors >= kPassive && state_.errors < kBusOff);
    assign(intf, kTxBo, state_.errors >= kBusOff);
    assign(intf, kEwarn, (intf & (kTxWarn | kRxWarn)) != 0);
}

// ---- reception

bool CanLine::receive(const CanFrame& frame, Cycle at) {
    const Mode mode = this->mode();
    if (state_.held || mode == Mode::Disable) {
        set_flags(kWakIf, at);
        return false;
    }
    const bool hears = mode == Mode::ListenOnly || mode == Mode::ListenAll || on_bus();
    if (!hears || state_.sending != kNobody) return false;
    state_.bus_free = at + bits(kIntermission);
    if (mode == Mode::Normal) {
        std::uint16_t& errors = reg(place_.ec);
        if (errors & 0xFF) --errors;
    }
    deliver(frame, at);
    if (state_.frame_due != kNoCycle && state_.frame_due < state_.bus_free)
        state_.frame_due = state_.bus_free;
    look_for_frame(at);
    plan();
    return mode == Mode::Normal;
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
