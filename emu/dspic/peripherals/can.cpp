#include "emu/dspic/peripherals/can.h"

#include "emu/dspic/peripherals/can_registers.h"

#include <algorithm>

namespace puckloop::dspic {

using namespace can;

namespace {

constexpr int kLast = kEc;
constexpr Cycle kIdleBits = 11;  // recessive bits that show an idle bus
constexpr Cycle kRecoveries = 128;
constexpr Cycle kIntermission = 3;
constexpr int kAckToEnd = 9;  // bits from the acknowledge slot to the end of the frame
constexpr unsigned kWarning = 96, kPassive = 128, kBusOff = 256;
constexpr unsigned kErrorStep = 8;
constexpr std::uint16_t kClearable = 0xFF | kRx0Ovr | kRx1Ovr;

}  // namespace

Can::Can(const Surroundings& around, const Setup& setup, Ports& ports, Pins& pins)
    : around_(around), setup_(setup), ports_(ports), pins_(pins), slot_(around.events.add(this, due)) {
    for (int offset = 0; offset <= kLast; offset += 2) {
        const auto address = static_cast<std::uint16_t>(setup_.base + offset);
        if (!around_.sfr.info(address)) continue;
        const bool transmits = offset >= kTx + 2 * kBufferStep && offset <= kTx + kBufferCon;
        const bool receives = offset >= kRx + kBufferStep && offset <= kRx + kBufferCon;
        WriteHook write = write_setup;  // filters, masks, timing
        if (transmits) write = write_transmit;
        if (receives) write = write_receive;
        if (offset == kCtrl) write = write_control;
        if (offset >= kIntf) write = write_interrupts;
        around_.sfr.hook(address, this, nullptr, write);
    }
}

void Can::reset() {
    state_ = {};
    around_.events.cancel(slot_);
}

Can::Mode Can::mode() const {
    return static_cast<Mode>(kCTRL["OPMODE"].of(reg(kCtrl)));
}

bool Can::on_bus() const {
    return mode() == Mode::Normal && state_.errors < kBusOff && !state_.held;
}

// A bit is 1 + PRSEG + SEG1PH + SEG2PH quanta of 2 (BRP + 1) / FCAN; FCAN is FCY, or four times that.
Cycle Can::bit_quarters() const {
    const unsigned cfg1 = reg(kCfg1), cfg2 = reg(kCfg2);
    const unsigned first = kCFG2["SEG1PH"].of(cfg2) + 1;
    const unsigned second = cfg2 & kCFG2["SEG2PHTS"] ? kCFG2["SEG2PH"].of(cfg2) + 1 : std::max(first, 2u);
    const unsigned quanta = 1 + kCFG2["PRSEG"].of(cfg2) + 1 + first + second;
    const unsigned clocks = quanta * 2 * (kCFG1["BRP"].of(cfg1) + 1);
    return reg(kCtrl) & kCTRL["CANCKS"] ? clocks * 4 : clocks;
}

void Can::plan() {
    around_.events.schedule(slot_, std::min({state_.mode_due, state_.frame_due, state_.recovery}));
}

void Can::due(void* owner, Cycle due) {
    Can& self = *static_cast<Can*>(owner);
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

void Can::hold(bool on) {
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

void Can::request_mode(Cycle at) {
    const auto wanted = static_cast<Mode>(kCTRL["REQOP"].of(reg(kCtrl)));
    if (wanted == mode()) {
        state_.mode_due = kNoCycle;
        return;
    }
    const bool listens = wanted == Mode::Normal || wanted == Mode::ListenOnly || wanted == Mode::ListenAll;
    state_.mode_due = at + (listens ? bits(kIdleBits) : 0);
    if (state_.sending != kNobody) state_.mode_due = std::max(state_.mode_due, state_.frame_due);
}

void Can::enter_mode(Cycle at) {
    std::uint16_t& ctrl = reg(kCtrl);
    const unsigned wanted = kCTRL["REQOP"].of(ctrl);
    ctrl = static_cast<std::uint16_t>((ctrl & ~kCTRL["OPMODE"]) | wanted << 5);
    if (mode() == Mode::Configuration) {
        state_.errors = 0;
        state_.recovery = kNoCycle;
        reg(kEc) = 0;
        show_errors();
    }
    lend_pins(at);
    look_for_frame(at);
}

void Can::lend_pins(Cycle at) {
    const std::uint16_t rx = bit(setup_.rx), tx = bit(setup_.tx);
    const bool off = mode() == Mode::Configuration || mode() == Mode::Disable;
    if (off)
        ports_.give_back(setup_.port, rx | tx);
    else
        ports_.lend(setup_.port, rx | tx, tx, tx, at);
}

// ---- transmission

CanFrame Can::frame_of(int buffer) const {
    const int base = kTx + kBufferStep * buffer;
    const unsigned sid = reg(base), eid = reg(base + 2), dlc = reg(base + 4);
    CanFrame frame;
    frame.extended = sid & kTXSID["TXIDE"];
    frame.id = kTXSID["SID10_6"].of(sid) << 6 | kTXSID["SID5_0"].of(sid);
    frame.remote = sid & kTXSID["SRR"];
    if (frame.extended) {
        frame.id = frame.id << 18 | kTXEID["EID17_14"].of(eid) << 14 | kTXEID["EID13_6"].of(eid) << 6 |
                   kTXDLC["EID5_0"].of(dlc);
        frame.remote = dlc & kTXDLC["TXRTR"];
    }
    frame.length = static_cast<std::uint8_t>(std::min(kTXDLC["DLC"].of(dlc), 8u));
    if (!frame.remote)
        for (int i = 0; i < frame.length; ++i)
            frame.data[static_cast<std::size_t>(i)] =
                static_cast<std::uint8_t>(reg(base + kData + (i & ~1)) >> (i % 2 ? 8 : 0));
    return frame;
}

// Plans the next frame if one is asked for and may be sent.
void Can::look_for_frame(Cycle at) {
    if (state_.sending != kNobody || state_.held) return;
    state_.frame_due = kNoCycle;
    if (state_.mode_due != kNoCycle) return;
    if (!on_bus() && mode() != Mode::Loopback) return;
    for (int buffer = 0; buffer < kTransmitters; ++buffer)
        if (reg(kTx + kBufferStep * buffer + kBufferCon) & kTXCON["TXREQ"])
            state_.frame_due = std::max(at, state_.bus_free);
}

// The highest TXPRI first, the highest buffer among equals.
void Can::send(Cycle at) {
    int best = -1;
    unsigned priority = 0;
    for (int buffer = 0; buffer < kTransmitters; ++buffer) {
        const unsigned con = reg(kTx + kBufferStep * buffer + kBufferCon);
        if (!(con & kTXCON["TXREQ"]) || (best >= 0 && kTXCON["TXPRI"].of(con) < priority)) continue;
        best = buffer;
        priority = kTXCON["TXPRI"].of(con);
    }
    if (best < 0) return;
    state_.sending = static_cast<std::uint8_t>(best);
    state_.frame = frame_of(best);
    state_.frame_due = at + bits(static_cast<Cycle>(can_bits(state_.frame)));
}

void Can::end_frame(Cycle at) {
    const int buffer = state_.sending;
    const CanFrame frame = state_.frame;
    std::uint16_t& con = reg(kTx + kBufferStep * buffer + kBufferCon);
    const bool loops = mode() == Mode::Loopback;
    const CanOutcome outcome =
        loops ? CanOutcome::Acknowledged : pins_.can_sent(setup_.unit, frame, at - bits(kAckToEnd));
    state_.sending = kNobody;
    state_.bus_free = at + bits(kIntermission);
    if (!loops) count_errors(outcome, at);
    assign(con, kTXCON["TXERR"], outcome != CanOutcome::Acknowledged);
    if (outcome == CanOutcome::Acknowledged) {
        assign(con, kTXCON["TXREQ"], false);
        set_flags(static_cast<std::uint16_t>(kTx0If << buffer), at);
        if (loops) deliver(frame, at);
    }
    look_for_frame(at);
}

// An error passive sender is not punished for a missing acknowledge.
void Can::count_errors(CanOutcome outcome, Cycle at) {
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

void Can::show_errors() {
    std::uint16_t& intf = reg(kIntf);
    const unsigned received = reg(kEc) & 0xFFu;
    reg(kEc) = static_cast<std::uint16_t>((state_.errors & 0xFFu) << 8 | received);
    assign(intf, kTxWarn, state_.errors >= kWarning);
    assign(intf, kTxBp, state_.errors >= kPassive && state_.errors < kBusOff);
    assign(intf, kTxBo, state_.errors >= kBusOff);
    assign(intf, kEwarn, (intf & (kTxWarn | kRxWarn)) != 0);
}

void Can::abort(int buffer) {
    if (state_.sending == buffer) return;  // what is on the wire goes on
    std::uint16_t& con = reg(kTx + kBufferStep * buffer + kBufferCon);
    assign(con, kTXCON["TXREQ"], false);
    con |= kTXCON["TXABT"];
}

// ---- interrupts

void Can::set_flags(std::uint16_t flags, Cycle at) {
    reg(kIntf) |= flags;
    show_code();
    if (flags & reg(kInte)) around_.interrupts.raise(setup_.irq, at);
}

// ICODE: the first in line of the enabled flags.
void Can::show_code() {
    constexpr std::uint16_t kOrder[] = {kWakIf,      kRx0If,      kRx0If << 1, kTx0If,
                                        kTx0If << 1, kTx0If << 2, kErrIf};
    constexpr unsigned kFirstCode = 7;
    const unsigned pending = reg(kIntf) & reg(kInte);
    unsigned code = 0;
    for (unsigned i = 0; i < std::size(kOrder) && code == 0; ++i)
        if (pending & kOrder[i]) code = kFirstCode - i;
    std::uint16_t& ctrl = reg(kCtrl);
    ctrl = static_cast<std::uint16_t>((ctrl & ~kCTRL["ICODE"]) | code << 1);
}

// ---- registers

void Can::write_control(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const auto writable = static_cast<std::uint16_t>(mask & ~(kCTRL["OPMODE"] | kCTRL["ICODE"]));
    self.around_.sfr.store(address, value, writable);
    const Cycle at = self.around_.now + 1;
    if (self.reg(kCtrl) & kCTRL["ABAT"]) {
        for (int buffer = 0; buffer < kTransmitters; ++buffer)
            if (self.reg(kTx + kBufferStep * buffer + kBufferCon) & kTXCON["TXREQ"]) self.abort(buffer);
        assign(self.reg(kCtrl), kCTRL["ABAT"], false);
    }
    self.request_mode(at);
    self.look_for_frame(at);
    self.plan();
}

void Can::write_transmit(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const int offset = address - self.setup_.base;
    const int buffer = (kTx + kBufferCon - offset) / -kBufferStep;
    std::uint16_t& con = self.reg(kTx + kBufferStep * buffer + kBufferCon);
    if ((offset & 0xE) != kBufferCon) {  // read only while it waits to be sent
        if (!(con & kTXCON["TXREQ"])) self.around_.sfr.store(address, value, mask);
        return;
    }
    const bool asked = con & kTXCON["TXREQ"];
    const Cycle at = self.around_.now + 1;
    self.around_.sfr.store(address, value,
                           static_cast<std::uint16_t>(mask & (kTXCON["TXREQ"] | kTXCON["TXPRI"])));
    if (!asked && (con & kTXCON["TXREQ"])) {
        con = static_cast<std::uint16_t>(con & ~(kTXCON["TXABT"] | kTXCON["TXLARB"] | kTXCON["TXERR"]));
    } else if (asked && !(con & kTXCON["TXREQ"])) {
        if (self.state_.sending == buffer) con |= kTXCON["TXREQ"];
        self.abort(buffer);
    }
    self.look_for_frame(at);
    self.plan();
}

// The program can only give a receive buffer back.
void Can::write_receive(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const int offset = address - self.setup_.base;
    std::uint16_t& con = self.around_.sfr.raw(address);
    if (offset == kRx + kBufferCon) self.around_.sfr.store(address, value, mask & kRX0CON["DBEN"]);
    if ((offset & 0xE) == kBufferCon && (mask & kRX0CON["RXFUL"]) && !(value & kRX0CON["RXFUL"]))
        assign(con, kRX0CON["RXFUL"], false);
}

void Can::write_setup(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    if (self.mode() == Mode::Configuration) self.around_.sfr.store(address, value, mask);
}

void Can::write_interrupts(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    Can& self = *static_cast<Can*>(owner);
    const int offset = address - self.setup_.base;
    std::uint16_t& stored = self.around_.sfr.raw(address);
    if (offset == kEc) return;  // read only
    const unsigned before = self.reg(kIntf) & self.reg(kInte);
    if (offset == kIntf)
        stored = static_cast<std::uint16_t>(stored & (value | ~(mask & kClearable)));
    else
        self.around_.sfr.store(address, value, mask);
    self.show_code();
    if (self.reg(kIntf) & self.reg(kInte) & ~before & 0xFFu)
        self.around_.interrupts.raise(self.setup_.irq, self.around_.now);
}

}  // namespace puckloop::dspic
