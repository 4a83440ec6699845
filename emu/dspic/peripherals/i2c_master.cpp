#include "emu/dspic/peripherals/i2c_master.h"

#include "emu/dspic/devices/dspic30f6014a_irq.h"
#include "emu/dspic/devices/dspic30f6014a_sfr.h"

#include <algorithm>
#include <cmath>

namespace puckloop::dspic {

using cosim::I2cPhaseKind;

namespace {

// I2CCON
constexpr std::uint16_t kI2cen = bit(15);
constexpr std::uint16_t kAcken = bit(4);
constexpr std::uint16_t kRcen = bit(3);
constexpr std::uint16_t kPen = bit(2);
constexpr std::uint16_t kRsen = bit(1);
constexpr std::uint16_t kSen = bit(0);
constexpr std::uint16_t kOneAtATime = kAcken | kRcen | kPen | kRsen | kSen;
// I2CSTAT
constexpr std::uint16_t kAckstat = bit(15);
constexpr std::uint16_t kTrstat = bit(14);
constexpr std::uint16_t kBcl = bit(10);
constexpr std::uint16_t kIwcol = bit(7);
constexpr std::uint16_t kI2cov = bit(6);
constexpr std::uint16_t kP = bit(4);
constexpr std::uint16_t kS = bit(3);
constexpr std::uint16_t kRbf = bit(1);
constexpr std::uint16_t kTbf = bit(0);
constexpr std::uint16_t kClearable = kBcl | kIwcol | kI2cov;

constexpr PortLetter kPort = PortLetter::G;
constexpr std::uint16_t kPins = bit(2) | bit(3);  // SCL, SDA
constexpr double kFixedHertz = 1'111'111.0;       // the part of the SCL period that does not depend on I2CBRG
constexpr double kStartClocks = 1.0;
constexpr double kRestartClocks = 1.5;
constexpr double kStopClocks = 1.5;
constexpr double kAcknowledgeClocks = 0.125;  // deviation 2
constexpr double kByteClocks = 9.0;
constexpr double kDataClocks = 8.0;
constexpr int kUnit = 1;

}  // namespace

I2cMaster::I2cMaster(const Surroundings& around, const cosim::ClockDomain& clock, Ports& ports, Pins& pins)
    : around_(around), clock_(clock), ports_(ports), pins_(pins), slot_(around.events.add(this, due)) {
    around_.sfr.hook(sfr::I2CRCV, this, read_rcv, nullptr);
    around_.sfr.hook(sfr::I2CTRN, this, nullptr, write_trn);
    around_.sfr.claim(sfr::I2CBRG);
    around_.sfr.hook(sfr::I2CCON, this, nullptr, write_con);
    around_.sfr.hook(sfr::I2CSTAT, this, nullptr, write_stat);
}

void I2cMaster::reset() {
    const bool awaited = state_.awaits_answer;
    const bool owned = state_.owns_bus;
    if (owned && !awaited) send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(around_.now));
    state_ = {};
    state_.awaits_answer = awaited;
    state_.stop_when_answered = awaited;
    around_.events.cancel(slot_);
}

// FSCL = 1 / ((BRG + 1) / FCY + 1 / 1,111,111 Hz)
double I2cMaster::clock_cycles() const {
    return around_.sfr.raw(sfr::I2CBRG) + 1.0 + clock_.hertz() / kFixedHertz;
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
    pins_.i2c_phase(kUnit, phase);
}

// An activity that ends by itself.
void I2cMaster::begin(Activity activity, double duration_clocks) {
    state_.activity = activity;
    state_.ends = around_.now + 1 + clocks(duration_clocks);
    around_.events.schedule(slot_, state_.ends);
}

void I2cMaster::stop_condition_seen(bool stopped) {
    std::uint16_t& stat = around_.sfr.raw(sfr::I2CSTAT);
    assign(stat, kP, stopped);
    assign(stat, kS, !stopped);
}

void I2cMaster::complete(Cycle at) {
    std::uint16_t& con = around_.sfr.raw(sfr::I2CCON);
    std::uint16_t& stat = around_.sfr.raw(sfr::I2CSTAT);
    switch (state_.activity) {
    case Activity::Start:
    case Activity::Restart:
        stop_condition_seen(false);
        state_.owns_bus = true;
        state_.address_next = true;
        break;
    case Activity::Stop:
        stop_condition_seen(true);
        break;
    case Activity::Transmit:
        stat = static_cast<std::uint16_t>(stat & ~(kTrstat | kTbf));
        break;
    case Activity::Receive:
    case Activity::Acknowledge:
    case Activity::Idle:
        break;
    }
    con = static_cast<std::uint16_t>(con & ~kOneAtATime);
    state_.activity = Activity::Idle;
    state_.ends = kNoCycle;
    around_.interrupts.raise(irq::MI2C, at);
}

void I2cMaster::due(void* owner, Cycle due) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    if (self.state_.buffer_empty <= due) {  // the eighth falling edge of a byte sent
        self.state_.buffer_empty = kNoCycle;
        assign(self.around_.sfr.raw(sfr::I2CSTAT), kTbf, false);
    }
    if (self.state_.ends <= due) {
        if (self.state_.activity == Activity::Transmit) self.around_.sfr.raw(sfr::I2CSTAT) |= kAckstat;
        self.complete(due);
    }
    self.around_.events.schedule(self.slot_, std::min(self.state_.buffer_empty, self.state_.ends));
}

void I2cMaster::answer(const cosim::I2cPhase& phase, Cycle at) {
    if (!state_.awaits_answer) return;
    state_.awaits_answer = false;
    if (state_.stop_when_answered) {
        state_.stop_when_answered = false;
        send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(at));
        return;
    }
    state_.buffer_empty = kNoCycle;
    around_.events.cancel(slot_);
    std::uint16_t& stat = around_.sfr.raw(sfr::I2CSTAT);
    if (phase.kind == I2cPhaseKind::BusLost) {
        stat |= kBcl;
        state_.owns_bus = false;
    } else if (state_.activity == Activity::Transmit) {
        assign(stat, kAckstat, !phase.ack);
    } else if (stat & kRbf) {
        stat |= kI2cov;
    } else {
        around_.sfr.raw(sfr::I2CRCV) = phase.byte;
        stat |= kRbf;
    }
    complete(at);
}

Cycle I2cMaster::earliest(Cycle now) const {
    if (state_.awaits_answer) return kNoCycle;
    if (state_.activity != Activity::Idle) return std::max(state_.ends, now + 1);
    if (state_.owns_bus) return now + 1;
    // A start condition, and with I2CBRG = 0 at that.
    return now + 1 + static_cast<Cycle>(kStartClocks * clock_.hertz() / kFixedHertz);
}

std::uint16_t I2cMaster::read_rcv(void* owner, std::uint16_t address) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    assign(self.around_.sfr.raw(sfr::I2CSTAT), kRbf, false);
    return self.around_.sfr.raw(address);
}

void I2cMaster::write_trn(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    State& state = self.state_;
    std::uint16_t& stat = self.around_.sfr.raw(sfr::I2CSTAT);
    if (!(self.around_.sfr.raw(sfr::I2CCON) & kI2cen) || mask == 0xFF00) {
        self.around_.sfr.store(address, value, mask);
        return;
    }
    if (state.activity != Activity::Idle || state.awaits_answer) {
        stat |= kIwcol;
        return;
    }
    self.around_.sfr.store(address, value, mask);
    stat |= kTbf | kTrstat;
    if (!state.owns_bus) {
        self.begin(Activity::Transmit, kByteClocks);
        return;
    }
    state.activity = Activity::Transmit;
    state.awaits_answer = true;
    state.buffer_empty = self.around_.now + 1 + self.clocks(kDataClocks);
    self.around_.events.schedule(self.slot_, state.buffer_empty);
    const bool address_byte = state.address_next;
    state.address_next = false;
    self.send(address_byte ? I2cPhaseKind::Start : I2cPhaseKind::Write, static_cast<std::uint8_t>(value), 0,
              self.clock_.time_of(self.around_.now + 1));
}

void I2cMaster::switch_off() {
    const bool owned = state_.owns_bus;
    const bool awaited = state_.awaits_answer;
    state_ = {};
    around_.events.cancel(slot_);
    state_.awaits_answer = awaited;
    state_.stop_when_answered = awaited;
    if (owned && !awaited) send(I2cPhaseKind::Stop, 0, 0, clock_.time_of(around_.now + 1));
    std::uint16_t& con = around_.sfr.raw(sfr::I2CCON);
    con = static_cast<std::uint16_t>(con & ~kOneAtATime);
    std::uint16_t& stat = around_.sfr.raw(sfr::I2CSTAT);
    stat = static_cast<std::uint16_t>(stat & ~(kTrstat | kTbf | kRbf));  // P and S stay, as firmware needs
}

void I2cMaster::write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    State& state = self.state_;
    std::uint16_t& con = self.around_.sfr.raw(address);
    const std::uint16_t old = con;
    // Hardware alone clears the activity bits; one that is set while another is active is ignored.
    self.around_.sfr.store(address, value, static_cast<std::uint16_t>(mask & ~kOneAtATime));
    if ((old ^ con) & kI2cen) {
        if (con & kI2cen) {
            self.ports_.lend(kPort, kPins, 0, 0);
        } else {
            self.ports_.give_back(kPort, kPins);
            self.switch_off();
        }
    }
    const std::uint16_t asked = value & mask & kOneAtATime;
    if (!(con & kI2cen) || !asked || state.activity != Activity::Idle || state.awaits_answer) return;
    const cosim::Time start = self.clock_.time_of(self.around_.now + 1);
    if (asked & kSen) {
        con |= kSen;
        self.begin(Activity::Start, kStartClocks);
    } else if (asked & kRsen) {
        con |= kRsen;
        self.begin(Activity::Restart, kRestartClocks);
    } else if (asked & kPen) {
        con |= kPen;
        const bool owned = state.owns_bus;
        state.owns_bus = false;
        self.begin(Activity::Stop, kStopClocks);
        if (owned) self.send(I2cPhaseKind::Stop, 0, 0, start);
    } else if (asked & kRcen) {
        con |= kRcen;
        if (!state.owns_bus) {  // an idle bus reads as ones
            self.around_.sfr.raw(sfr::I2CRCV) = 0xFF;
            self.around_.sfr.raw(sfr::I2CSTAT) |= kRbf;
            self.begin(Activity::Receive, kDataClocks);
            return;
        }
        state.activity = Activity::Receive;
        state.awaits_answer = true;
        self.send(I2cPhaseKind::Read, 0, 1, start);
    } else {
        con |= kAcken;
        self.begin(Activity::Acknowledge, kAcknowledgeClocks);
    }
}

void I2cMaster::write_stat(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask) {
    I2cMaster& self = *static_cast<I2cMaster*>(owner);
    std::uint16_t& stat = self.around_.sfr.raw(address);
    stat = static_cast<std::uint16_t>(stat & (~(mask & kClearable) | value));
}

}  // namespace puckloop::dspic
