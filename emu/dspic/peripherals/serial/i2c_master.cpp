#include "emu/dspic/peripherals/serial/i2c_master.h"

#include "cosim/i2c/i2c_shared.h"
#include "emu/dspic/peripherals/serial/i2c_registers.h"
#include "emu/dspic/peripherals/serial/i2c_slave.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::dspic {

using cosim::I2cPhaseKind;

namespace {

using namespace i2c;

constexpr std::uint16_t kOneAtATime =
    kI2CxCON["ACKEN"] | kI2CxCON["RCEN"] | kI2CxCON["PEN"] | kI2CxCON["RSEN"] | kI2CxCON["SEN"];

constexpr double kStartClocks = 1.0;
constexpr double kRestartClocks = 1.5;
constexpr double kStopClocks = 1.5;
constexpr double kAcknowledgeClocks = 0.125;  // deviation 2
constexpr double kByteClocks = 9.0;
constexpr double kDataClocks = 8.0;
constexpr std::uint8_t kReservedAddress = 0xFF;
constexpr std::uint8_t kFirstBit = 0x80, kReleased = 0xFF, kRead = 1;
constexpr std::uint8_t kNinthPlace = 8;

}  // namespace

I2cMaster::I2cMaster(const Surroundings& around, const Setup& setup, const cosim::ClockDomain& clock,
                     Ports& ports, Pins& pins)
    : around_(around),
      setup_(setup),
      clock_(clock),
      ports_(ports),
      pins_(pins),
      slot_(around.events.add(this, due)) {
    const auto at = [&](int offset) { return static_cast<std::uint16_t>(setup_.rcv + offset); };
    around_.sfr.hook(at(kRcv), this, read_rcv, nullptr);
    around_.sfr.hook(at(kTrn), this, nullptr, write_trn);
    around_.sfr.claim(at(kBrg));
    around_.sfr.hook(at(kCon), this, nullptr, write_con);
    around_.sfr.hook(at(kStat), this, nullptr, write_stat);
}

void I2cMaster::reset() {
    const bool awaited = state_.awaits_answer;
    const bool owned = state_.owns_bus;
    if (owned && !awaited) send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(around_.now));
    state_ = {};
    state_.awaits_answer = awaited;
    state_.stop_when_answered = awaited;
    plan();
}

// FSCL = 1 / ((BRG + 1) / FCY + 1 / fixed_hertz)
double I2cMaster::clock_cycles() const {
    return reg(kBrg) + 1.0 + clock_.hertz() / setup_.fixed_hertz;
}

Cycle I2cMaster::clocks(double count) const {
    return static_cast<Cycle>(std::llround(count * clock_cycles()));
}

void I2cMaster::send(I2cPhaseKind kind, std::uint8_t byte, std::uint8_t ack, cosim::Time start) {
    cosim::I2cPhase phase;
    phase.kind = kind;
    phase.byte = byte;
    phase.ack = ack;
    phase.start = start;
    phase.clock_period = static_cast<cosim::Time>(clock_cycles() / clock_.hertz() * cosim::kSecond);
    pins_.i2c_phase(setup_.unit, phase);
}

double I2cMaster::duration_of(Activity activity) {
    switch (activity) {
    case Activity::Start:
        return kStartClocks;
    case Activity::Restart:
        return kRestartClocks;
    case Activity::Stop:
        return kStopClocks;
    case Activity::Transmit:
        return kByteClocks;
    case Activity::Receive:
        return kDataClocks;
    case Activity::Acknowledge:
        return kAcknowledgeClocks;
    case Activity::Idle:
        break;
    }
    return 0.0;
}

// An activity that ends by itself. While the bus still has what was switched off, it waits (deviation 4).
void I2cMaster::begin_at(Activity activity, Cycle from) {
    state_.activity = activity;
    state_.ends = state_.stop_when_answered ? kNoCycle : from + clocks(duration_of(activity));
    plan();
}

void I2cMaster::stop_condition_seen(bool stopped) {
    std::uint16_t& stat = reg(kStat);
    assign(stat, kI2CxSTAT["P"], stopped);
    assign(stat, kI2CxSTAT["S"], !stopped);
}

/// The next byte follows one that was read and not acknowledged: the slave is to know.
void I2cMaster::end_byte_read(cosim::Time start) {
    if (state_.received && !state_.acknowledged && !state_.shared) {
        send(I2cPhaseKind::Acknowledge, 0, 0, start);
        if (state_.reads) state_.heard = false;
    }
    state_.received = false;
}

/// Whether the clocks of what is asked for are not those of a byte of slaves that receive, or its ninth.
bool I2cMaster::out_of_step(Activity activity) const {
    if (!state_.heard || state_.reads || state_.shared || !state_.owns_bus || state_.address_next)
        return false;
    return state_.clocks != (activity == Activity::Acknowledge ? kNinthPlace : 0);
}

/// Clocks of a byte, or of an acknowledge, that slaves find in the middle of theirs (deviation 3).
void I2cMaster::send_loose(Activity activity, std::uint8_t byte) {
    const int count = activity == Activity::Acknowledge ? 1
                      : activity == Activity::Receive   ? static_cast<int>(kDataClocks)
                                                        : static_cast<int>(kByteClocks);
    const cosim::LooseClocks clocks{state_.clocks, count};
    state_.received = state_.ninth_low = address_sent_ = false;
    state_.clocks = static_cast<std::uint8_t>(clocks.after());
    state_.activity = activity;
    state_.loose = state_.awaits_answer = clocks.answered();
    send(I2cPhaseKind::Data, byte, clocks.packed(), clock_.time_of(around_.now + 1));
    if (clocks.answered()) return;
    state_.ends = around_.now + 1 + this->clocks(1.0);
    plan();
}

/// What a slave that sends puts on SDA next is in the way of a stop and of a repeated start.
bool I2cMaster::asks_first_bit() const {
    return state_.heard && state_.reads && !state_.shared && state_.owns_bus && state_.clocks == 0;
}

void I2cMaster::ask_first_bit(Activity activity, cosim::Time start) {
    state_.activity = activity;
    state_.awaits_answer = state_.first_bit_asked = true;
    send(I2cPhaseKind::Acknowledge, 0, cosim::kNoByteFollows, start);
}

void I2cMaster::first_bit_known(bool high, Cycle at) {
    const Activity activity = state_.activity;
    state_.heard = state_.received = false;
    if (!high) {
        reg(kStat) |= kI2CxSTAT["BCL"];
        state_.owns_bus = false;
        state_.activity = Activity::Idle;
        return complete(at);
    }
    if (activity == Activity::Stop) {
        state_.owns_bus = false;
        send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(at));
    }
    begin_at(activity, at);
}

/// What is asked for makes a clock or a condition with SDA high, where a device that was read though it is to
/// receive holds SDA low: its acknowledge, which ends with this clock.
bool I2cMaster::finds_low(std::uint16_t asked) {
    if (!std::exchange(state_.ninth_low, false) || !state_.owns_bus || state_.shared) return false;
    if (asked & (kI2CxCON["PEN"] | kI2CxCON["RSEN"] | kI2CxCON["SEN"])) return true;
    return (asked & kI2CxCON["ACKEN"]) && (reg(kCon) & kI2CxCON["ACKDT"]);
}

/// SDA was low: a collision (DS70068, 21.5.6 and 21.11). The bus is left as it is.
void I2cMaster::collide(Cycle at) {
    std::uint16_t& stat = reg(kStat);
    stat = static_cast<std::uint16_t>((stat | kI2CxSTAT["BCL"]) & ~(kI2CxSTAT["TRSTAT"] | kI2CxSTAT["TBF"]));
    state_.collides = state_.owns_bus = state_.received = state_.heard = false;
    send(I2cPhaseKind::BusLost, 0, 0, clock_.time_of(at));
    reg(kCon) = static_cast<std::uint16_t>(reg(kCon) & ~kOneAtATime);
    state_.activity = Activity::Idle;
    state_.ends = state_.buffer_empty = kNoCycle;
    around_.interrupts.raise(setup_.master_irq, at);
}

void I2cMaster::complete(Cycle at) {
    if (state_.collides) return collide(at);
    std::uint16_t& con = reg(kCon);
    std::uint16_t& stat = reg(kStat);
    switch (state_.activity) {
    case Activity::Start:
    case Activity::Restart:
        stop_condition_seen(false);
        state_.owns_bus = true;
        state_.address_next = true;
        state_.received = state_.ninth_low = state_.heard = false;
        break;
    case Activity::Stop:
        stop_condition_seen(true);
        state_.shared = state_.heard = false;
        break;
    case Activity::Transmit:
        stat = static_cast<std::uint16_t>(stat & ~(kI2CxSTAT["TRSTAT"] | kI2CxSTAT["TBF"]));
        break;
    case Activity::Receive:
    case Activity::Acknowledge:
    case Activity::Idle:
        break;
    }
    con = static_cast<std::uint16_t>(con & ~kOneAtATime);
    state_.activity = Activity::Idle;
    state_.ends = kNoCycle;
    around_.interrupts.raise(setup_.master_irq, at);
}

void I2cMaster::due(void* owner, Cycle due) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    if (self.known_at_ <= due) {
        self.known_at_ = kNoCycle;
        self.answer(self.known_, due);
        return self.plan();
    }
    if (self.state_.buffer_empty <= due) {  // the eighth falling edge of a byte sent
        self.state_.buffer_empty = kNoCycle;
        assign(self.reg(kStat), kI2CxSTAT["TBF"], false);
    }
    if (self.state_.ends <= due) {
        if (self.state_.activity == Activity::Transmit && !self.state_.collides)
            self.reg(kStat) |= kI2CxSTAT["ACKSTAT"];
        self.complete(due);
    }
    self.plan();
}

void I2cMaster::answer_at(const cosim::I2cPhase& phase, Cycle at) {
    known_ = phase;
    known_at_ = at;
    plan();
}

void I2cMaster::answer(const cosim::I2cPhase& phase, Cycle at) {
    if (!state_.awaits_answer) return;
    if (phase.kind == cosim::kSharedNotice) {
        state_.shared = true;
        return;
    }
    state_.awaits_answer = false;
    if (state_.stop_when_answered) {
        state_.stop_when_answered = false;
        send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(at));
        if (state_.activity != Activity::Idle) begin_at(state_.activity, at + 1);
        return;
    }
    state_.buffer_empty = kNoCycle;
    around_.events.cancel(slot_);
    if (std::exchange(state_.first_bit_asked, false))
        return first_bit_known(phase.kind != I2cPhaseKind::BusLost, at);
    std::uint16_t& stat = reg(kStat);
    if (phase.kind == I2cPhaseKind::BusLost) {
        stat |= kI2CxSTAT["BCL"];
        state_.owns_bus = state_.shared = state_.ninth_low = state_.heard = state_.loose = false;
        if (state_.activity == Activity::Stop) state_.activity = Activity::Idle;  // none was made
    } else if (std::exchange(state_.loose, false)) {
        state_.ninth_low = phase.ack & cosim::LooseClocks::kHeldLow;
        if (state_.activity == Activity::Receive) take_byte(phase);
        if (state_.activity == Activity::Transmit)
            assign(stat, kI2CxSTAT["ACKSTAT"], !(phase.ack & cosim::LooseClocks::kLineLow));
    } else if (state_.activity == Activity::Acknowledge || state_.activity == Activity::Stop) {
        // The bus says when it is over.
    } else if (state_.activity == Activity::Transmit) {
        assign(stat, kI2CxSTAT["ACKSTAT"], !phase.ack);
        if (!phase.ack && address_sent_) ++refused_[sent_address_];
        if (address_sent_) state_.heard = phase.ack;
    } else {
        state_.ninth_low = phase.ack == cosim::kDeviceAcknowledges;
        state_.clocks = kNinthPlace;
        take_byte(phase);
    }
    complete(at);
}

void I2cMaster::take_byte(const cosim::I2cPhase& phase) {
    std::uint16_t& stat = reg(kStat);
    if (stat & kI2CxSTAT["RBF"]) {
        stat |= kI2CxSTAT["I2COV"];
    } else {
        reg(kRcv) = phase.byte;
        stat |= kI2CxSTAT["RBF"];
    }
}

Cycle I2cMaster::earliest(Cycle now) const {
    if (state_.awaits_answer) return known_at_ == kNoCycle ? kNoCycle : std::max(known_at_, now);
    if (state_.activity != Activity::Idle) return std::max(state_.ends, now + 1);
    if (state_.owns_bus) return now + 1;
    // A start condition, and with I2CBRG = 0 at that.
    return now + 1 + static_cast<Cycle>(kStartClocks * clock_.hertz() / setup_.fixed_hertz);
}

std::uint16_t I2cMaster::read_rcv(void* owner, std::uint16_t address) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    assign(self.reg(kStat), kI2CxSTAT["RBF"], false);
    return self.around_.sfr.raw(address);
}

void I2cMaster::write_trn(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    State& state = self.state_;
    std::uint16_t& stat = self.reg(kStat);
    if (!(self.reg(kCon) & kI2CxCON["I2CEN"]) || mask == 0xFF00) {
        self.around_.sfr.store(address, value, mask);
        return;
    }
    if (self.slave_ && self.slave_->transmitting()) return self.slave_->load(value);
    if (state.activity != Activity::Idle || self.busy()) {
        stat |= kI2CxSTAT["IWCOL"];
        return;
    }
    self.around_.sfr.store(address, value, mask);
    stat |= kI2CxSTAT["TBF"] | kI2CxSTAT["TRSTAT"];
    if (!state.owns_bus) {
        self.begin(Activity::Transmit);
        return;
    }
    state.activity = Activity::Transmit;
    state.awaits_answer = true;
    state.buffer_empty = self.around_.now + 1 + self.clocks(kDataClocks);
    self.around_.events.schedule(self.slot_, state.buffer_empty);
    const bool address_byte = state.address_next;
    if (self.out_of_step(Activity::Transmit))
        return self.send_loose(Activity::Transmit, static_cast<std::uint8_t>(value));
    const bool behind_ninth = state.heard && state.reads && state.clocks == kNinthPlace && !state.shared;
    if (!address_byte && behind_ninth && !(value & kFirstBit))
        return self.transmit_behind_ninth(static_cast<std::uint8_t>(value));
    if (!address_byte) {
        self.end_byte_read(self.clock_.time_of(self.around_.now + 1));
        if (state.reads) state.heard = false;  // its byte is not acknowledged
    }
    state.address_next = false;
    state.clocks = 0;
    if (address_byte) state.reads = value & kRead;
    self.address_sent_ = address_byte;
    self.sent_address_ = static_cast<std::uint8_t>(value >> 1 & 0x7F);
    self.send(address_byte ? I2cPhaseKind::Start : I2cPhaseKind::Write, static_cast<std::uint8_t>(value), 0,
              self.clock_.time_of(self.around_.now + 1));
}

/// The first bit, a 0, was the ninth clock of the slave's byte before, whose next is then over but for its
/// own.
void I2cMaster::transmit_behind_ninth(std::uint8_t byte) {
    state_.ninth_low = address_sent_ = state_.acknowledged = false;
    state_.received = true;
    send(I2cPhaseKind::Write, static_cast<std::uint8_t>(byte << 1 | 1), cosim::kBehindNinthClock,
         clock_.time_of(around_.now + 1));
}

void I2cMaster::switch_off() {
    const bool owned = state_.owns_bus;
    const bool awaited = state_.awaits_answer;
    state_ = {};
    state_.awaits_answer = awaited;
    state_.stop_when_answered = awaited;
    plan();
    if (owned && !awaited) send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(around_.now + 1));
    std::uint16_t& con = reg(kCon);
    con = static_cast<std::uint16_t>(con & ~kOneAtATime);
    std::uint16_t& stat = reg(kStat);
    stat = static_cast<std::uint16_t>(stat & ~(kI2CxSTAT["TRSTAT"] | kI2CxSTAT["TBF"] |
                                               kI2CxSTAT["RBF"]));  // P and S stay, as firmware needs
}

void I2cMaster::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    State& state = self.state_;
    std::uint16_t& con = self.around_.sfr.raw(address);
    const std::uint16_t old = con;
    // Hardware alone clears the activity bits; one that is set while another is active is ignored.
    self.around_.sfr.store(address, value, static_cast<std::uint16_t>(mask & ~kOneAtATime));
    if (self.slave_) self.slave_->control_written(old);
    if ((old ^ con) & kI2CxCON["I2CEN"]) {
        const auto pins = static_cast<std::uint16_t>(bit(self.setup_.scl) | bit(self.setup_.sda));
        if (con & kI2CxCON["I2CEN"]) {
            self.ports_.take_over(self.setup_.port, pins, 0, 0);
        } else {
            self.ports_.release(self.setup_.port, pins);
            self.switch_off();
        }
    }
    const std::uint16_t asked = value & mask & kOneAtATime;
    if (!(con & kI2CxCON["I2CEN"]) || !asked || state.activity != Activity::Idle || self.busy()) return;
    if (!(asked & kI2CxCON["RCEN"]) && self.finds_low(asked)) {
        state.collides = true;
        con = static_cast<std::uint16_t>(con | (asked & kOneAtATime));
        return self.begin(asked & kI2CxCON["SEN"]    ? Activity::Start
                          : asked & kI2CxCON["RSEN"] ? Activity::Restart
                          : asked & kI2CxCON["PEN"]  ? Activity::Stop
                                                     : Activity::Acknowledge);
    }
    const cosim::Time start = self.clock_.time_of(self.around_.now + 1);
    if (asked & kI2CxCON["SEN"]) {
        if (!state.owns_bus && self.slave_ && self.slave_->bus_taken()) {  // SDA or SCL is low
            self.reg(kStat) |= kI2CxSTAT["BCL"];
            self.around_.interrupts.raise(self.setup_.master_irq, self.around_.now + 1);
            return;
        }
        con |= kI2CxCON["SEN"];
        if (self.asks_first_bit()) return self.ask_first_bit(Activity::Start, start);
        self.begin(Activity::Start);
    } else if (asked & kI2CxCON["RSEN"]) {
        con |= kI2CxCON["RSEN"];
        if (self.asks_first_bit()) return self.ask_first_bit(Activity::Restart, start);
        self.begin(Activity::Restart);
    } else if (asked & kI2CxCON["PEN"]) {
        con |= kI2CxCON["PEN"];
        if (self.asks_first_bit()) return self.ask_first_bit(Activity::Stop, start);
        const bool owned = state.owns_bus;
        state.owns_bus = false;
        if (state.shared) {  // SCL rises when the other master lets it
            state.activity = Activity::Stop;
            state.awaits_answer = true;
        } else {
            self.begin(Activity::Stop);
        }
        if (owned) self.send(I2cPhaseKind::Stop, 0, 0, start);
    } else if (asked & kI2CxCON["RCEN"]) {
        con |= kI2CxCON["RCEN"];
        if (!state.owns_bus) {  // an idle bus reads as ones
            self.reg(kRcv) = 0xFF;
            self.reg(kStat) |= kI2CxSTAT["RBF"];
            self.begin(Activity::Receive);
            return;
        }
        if (self.out_of_step(Activity::Receive)) return self.send_loose(Activity::Receive, kReleased);
        self.end_byte_read(start);
        state.activity = Activity::Receive;
        state.awaits_answer = state.received = true;
        state.acknowledged = false;
        if (std::exchange(state.address_next, false)) {  // eight ones behind a START: nobody's address
            self.address_sent_ = false;
            self.send(I2cPhaseKind::Start, kReservedAddress, 0, start);
            return;
        }
        self.send(I2cPhaseKind::Read, 0, state.shared ? cosim::kAcknowledgedLater : std::uint8_t{1}, start);
    } else {
        con |= kI2CxCON["ACKEN"];
        const bool refuses = con & kI2CxCON["ACKDT"];
        if (self.out_of_step(Activity::Acknowledge))
            return self.send_loose(Activity::Acknowledge, refuses ? kReleased : 0);
        if (state.reads && refuses && state.clocks == kNinthPlace) state.heard = false;
        state.clocks = 0;
        state.acknowledged = !refuses;
        if (!state.shared || !state.owns_bus) return self.begin(Activity::Acknowledge);
        state.activity = Activity::Acknowledge;
        state.awaits_answer = true;
        state.received = false;
        self.send(I2cPhaseKind::Acknowledge, 0, state.acknowledged ? 1 : 0, start);
    }
}

void I2cMaster::write_stat(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    std::uint16_t& stat = self.around_.sfr.raw(address);
    stat = static_cast<std::uint16_t>(stat & (~(mask & kClearable) | value));
}

}  // namespace puckloop::dspic
