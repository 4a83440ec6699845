#include "emu/dspic/peripherals/serial/i2c_slave.h"

#include "cosim/i2c/i2c_shared.h"
#include "emu/dspic/peripherals/serial/i2c_registers.h"

#include <algorithm>

namespace puckloop::dspic {

using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

using namespace i2c;

constexpr int kAnswerClocks = 8;
constexpr int kByteClocks = 9;
constexpr std::uint8_t kIdleLine = 0xFF, kFirstBit = 0x80;

Time clocks(const I2cPhase& phase, int count) {
    return phase.clock_period * count;
}

}  // namespace

I2cSlave::I2cSlave(const Surroundings& around, const I2cMaster::Setup& setup, const cosim::ClockDomain& clock,
                   Pins& pins)
    : around_(around), setup_(setup), clock_(clock), pins_(pins), slot_(around.events.add(this, due)) {
    around_.sfr.claim(static_cast<std::uint16_t>(setup_.rcv + kAdd));
    if (setup_.has_mask) around_.sfr.claim(static_cast<std::uint16_t>(setup_.rcv + kMsk));
}

// The bus is never left without an answer.
void I2cSlave::reset() {
    const State old = state_;
    state_ = {};
    around_.events.cancel(slot_);
    if (old.step == Step::None) return;
    open(old.open);
}

/// The last cycle that starts at or before `time`: what happens in it is reported no later than that.
Cycle I2cSlave::cycle_before(Time time) const {
    const Cycle cycle = clock_.first_cycle_at(time);
    return cycle > 0 && clock_.time_of(cycle) > time ? cycle - 1 : cycle;
}

bool I2cSlave::released() const {
    return reg(kCon) & kI2CxCON["SCLREL"];
}

bool I2cSlave::matches(std::uint8_t address_byte) const {
    const std::uint16_t con = reg(kCon);
    if (!(con & kI2CxCON["I2CEN"])) return false;
    if (con & kI2CxCON["IPMIEN"]) return true;
    if (address_byte == 0) return con & kI2CxCON["GCEN"];
    if (con & kI2CxCON["A10M"]) return matches_first_of_ten(address_byte);
    const unsigned address = address_byte >> 1, mask = setup_.has_mask ? reg(kMsk) : 0u;
    // Where there is a mask, reserved addresses match never, whatever it is (DS70195, table of reserved
    // addresses).
    constexpr unsigned kFirst = 0x08, kLast = 0x77;
    if (setup_.has_mask && (address < kFirst || address > kLast)) return false;
    return ((address ^ reg(kAdd)) & ~mask & 0x7F) == 0;
}

bool I2cSlave::ten_bits() const {
    return (reg(kCon) & kI2CxCON["A10M"]) && !(reg(kCon) & kI2CxCON["IPMIEN"]);
}

// 11110 A9 A8 R/W; a read is for who was addressed by both bytes before.
bool I2cSlave::matches_first_of_ten(std::uint8_t address_byte) const {
    const unsigned mask = setup_.has_mask ? reg(kMsk) >> 8 & 3u : 0u;
    if ((address_byte & 0xF8) != 0xF0 || (((address_byte >> 1) ^ (reg(kAdd) >> 8)) & ~mask & 3u))
        return false;
    return !(address_byte & 1) || state_.whole;
}

bool I2cSlave::matches_second_of_ten(std::uint8_t byte) const {
    const unsigned mask = setup_.has_mask ? reg(kMsk) : 0u;
    return ((byte ^ reg(kAdd)) & ~mask & 0xFFu) == 0;
}

void I2cSlave::phase(const I2cPhase& phase, Cycle at) {
    if (state_.ended_due != kNoCycle) not_acknowledged();
    switch (phase.kind) {
    case I2cPhaseKind::Start:
        start(phase);
        break;
    case I2cPhaseKind::Write:
    case I2cPhaseKind::Read:
        byte(phase, at);
        break;
    case I2cPhaseKind::Stop:
        stop();
        break;
    case I2cPhaseKind::Acknowledge:  // the ninth clock of the byte before, where that was not known then
        if (phase.ack == 0)
            not_acknowledged();
        else
            first_bit(phase, at);
        break;
    case I2cPhaseKind::Data:
    case I2cPhaseKind::BusLost:
        break;
    }
    plan();
}

/// Whether anybody is here or not, the eighth clock brings the answer.
void I2cSlave::open(const I2cPhase& phase) {
    state_.open = phase;
    state_.step = Step::Answer;
    state_.released = phase.start;
    state_.step_due = std::max(cycle_before(phase.start + clocks(phase, kAnswerClocks)), around_.now + 1);
    plan();
}

void I2cSlave::start(const I2cPhase& phase) {
    end_byte_sent();
    std::uint16_t& stat = reg(kStat);
    if (reg(kCon) & kI2CxCON["I2CEN"]) {
        assign(stat, kI2CxSTAT["S"], true);
        assign(stat, kI2CxSTAT["P"], false);
    }
    state_.taken = reg(kCon) & kI2CxCON["I2CEN"];
    state_.addressed = matches(phase.byte);
    state_.sends = phase.byte & 1;
    state_.byte_sent = false;
    state_.shown_due = kNoCycle;
    state_.half = state_.addressed && ten_bits() && phase.byte != 0 && !state_.sends;
    open(phase);
    if (!state_.addressed || state_.half) return;
    state_.shown_due = clock_.first_cycle_at(phase.start + clocks(phase, kByteClocks));
    state_.shows_address = true;
    state_.shown = phase.byte;
}

/// Who sends and who receives was agreed with the address; a master that does not keep to it finds the slave
/// sending while it sends, or receiving ones while it reads.
void I2cSlave::byte(const I2cPhase& phase, Cycle at) {
    if (!transmitting()) return open(phase);
    state_.open = phase;
    next_byte(at);
}

/// A START or STOP follows instead of a byte, and meets the first bit of the one that is to be sent.
void I2cSlave::first_bit(const I2cPhase& phase, Cycle at) {
    if (!transmitting()) return open(phase);
    state_.open = phase;
    next_byte(at);
    state_.byte_sent = false;
}

void I2cSlave::next_byte(Cycle at) {
    state_.released = state_.open.start;
    state_.step_due = kNoCycle;
    if (state_.byte_sent) {  // the byte before was acknowledged
        wait_for_byte();
        around_.interrupts.raise(setup_.slave_irq, at);
    }
    // Until the address is shown SCLREL still reads as before it.
    if (released() && state_.shown_due == kNoCycle)
        let_go(state_.open.start);
    else
        state_.step = Step::Hold;
}

/// SCL goes up from `from` on: for the byte to send, or for what its first bit leaves of SDA.
void I2cSlave::let_go(Time from) {
    if (state_.open.kind != I2cPhaseKind::Acknowledge) return shift(from);
    state_.released = std::max(from, state_.open.start);
    state_.step = Step::Answer;
    state_.step_due =
        std::max(cycle_before(state_.released + clocks(state_.open, kAnswerClocks)), around_.now);
}

/// SDA is high in the ninth clock of a byte sent: the transfer is over for the slave, until the next START.
void I2cSlave::not_acknowledged() {
    state_.ended_due = kNoCycle;
    if (!transmitting()) return;
    state_.addressed = false;
    assign(reg(kStat), kI2CxSTAT["TBF"], false);
}

/// A START or STOP right after a byte sent: it was the last one (deviation 2).
void I2cSlave::end_byte_sent() {
    if (state_.byte_sent && state_.step == Step::None) not_acknowledged();
}

void I2cSlave::stop() {
    end_byte_sent();
    std::uint16_t& stat = reg(kStat);
    if (reg(kCon) & kI2CxCON["I2CEN"]) {
        assign(stat, kI2CxSTAT["S"], false);
        assign(stat, kI2CxSTAT["P"], true);
        assign(stat, kI2CxSTAT["GCSTAT"], false);
        assign(stat, kI2CxSTAT["ADD10"], false);
    }
    state_.taken = state_.half = state_.whole = false;
    if (transmitting()) assign(reg(kCon), kI2CxCON["SCLREL"], true);
    state_.addressed = state_.byte_sent = false;
    if (state_.step != Step::None) state_.shown_due = kNoCycle;  // in the middle of a byte
    state_.step = Step::None;
    state_.step_due = kNoCycle;
}

void I2cSlave::hold_clock() {
    assign(reg(kCon), kI2CxCON["SCLREL"], false);
}

/// SCL is held for a byte to send, unless the program has put one into I2CxTRN already (DS70150E, 17.5.1).
void I2cSlave::wait_for_byte() {
    if (!(reg(kStat) & kI2CxSTAT["TBF"])) hold_clock();
}

// Puts a byte into I2CxRCV, status with it, and asks for service.
void I2cSlave::show(bool address, std::uint8_t byte, Cycle at) {
    std::uint16_t& stat = reg(kStat);
    if (stat & kI2CxSTAT["RBF"]) {
        stat |= kI2CxSTAT["I2COV"];
    } else {
        reg(kRcv) = byte;
        stat |= kI2CxSTAT["RBF"];
    }
    assign(stat, kI2CxSTAT["D_A"], !address);
    if (address) {
        assign(stat, kI2CxSTAT["R_W"], state_.sends);
        assign(stat, kI2CxSTAT["GCSTAT"], byte == 0 && !state_.whole);
        assign(stat, kI2CxSTAT["ADD10"], state_.whole);
        if (state_.sends && state_.addressed) {
            wait_for_byte();
            // The master may have begun the byte before the address was shown.
            if (state_.step == Step::Hold && released()) let_go(state_.open.start);
        }
    }
    around_.interrupts.raise(setup_.slave_irq, at);
}

/// The byte to send leaves from `from` on.
void I2cSlave::shift(Time from) {
    state_.released = std::max(from, state_.open.start);
    state_.step = Step::Shift;
    state_.step_due =
        std::max(cycle_before(state_.released + clocks(state_.open, kAnswerClocks)), around_.now);
}

void I2cSlave::answer(Time stretch, bool acknowledge, std::uint8_t byte) {
    I2cPhase answer = state_.open;
    const bool data = answer.kind == I2cPhaseKind::Read;
    answer.kind = data ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge;
    answer.ack = acknowledge;
    answer.byte = byte;
    answer.stretch = stretch;
    state_.step = Step::None;
    state_.step_due = kNoCycle;
    pins_.i2c_slave_answer(setup_.unit, answer);
}

// The byte on the bus is complete; the acknowledge is put on the line. A byte that was not read yet leaves no
// room for another.
void I2cSlave::eighth_clock(Cycle at) {
    const Time eighth = state_.open.start + clocks(state_.open, kAnswerClocks);
    const Time late = std::max<Time>(0, clock_.time_of(at) - eighth);
    if (state_.open.kind == I2cPhaseKind::Acknowledge)
        return answer(late, transmitting() && !(reg(kTrn) & kFirstBit), kIdleLine);
    const bool is_address = state_.open.kind == I2cPhaseKind::Start;
    const bool is_data = !is_address && !state_.sends;
    const std::uint8_t received = state_.open.kind == I2cPhaseKind::Read ? kIdleLine : state_.open.byte;
    const bool overrun = reg(kStat) & (kI2CxSTAT["RBF"] | kI2CxSTAT["I2COV"]);
    state_.acknowledge = state_.addressed && (is_data || is_address) && !overrun;
    // Only a read by the first byte again keeps what both bytes addressed.
    if (is_address && !(state_.addressed && ten_bits() && state_.sends)) state_.whole = false;
    if (is_data && state_.half) {  // the rest of a 10-bit address
        state_.half = false;
        state_.whole = state_.acknowledge = state_.acknowledge && matches_second_of_ten(received);
        state_.addressed = state_.whole;
        if (state_.whole) {
            state_.shown_due = clock_.first_cycle_at(state_.open.start + clocks(state_.open, kByteClocks));
            state_.shows_address = true;
            state_.shown = received;
        }
        return answer(late, state_.acknowledge, kIdleLine);
    }
    if (state_.addressed && is_data) {
        if (state_.acknowledge && (reg(kCon) & kI2CxCON["STREN"])) {
            state_.step = Step::Stretch;
            state_.step_due = kNoCycle;
            hold_clock();
            return show(false, received, at);
        }
        state_.shown_due = clock_.first_cycle_at(state_.open.start + clocks(state_.open, kByteClocks));
        state_.shows_address = false;
        state_.shown = received;
    }
    if (is_address && !state_.acknowledge) state_.addressed = false;
    answer(late, state_.acknowledge, kIdleLine);
}

void I2cSlave::due(void* owner, Cycle due) {
    I2cSlave& self = *static_cast<I2cSlave*>(owner);
    State& state = self.state_;
    if (state.step_due <= due && state.step == Step::Shift) {
        assign(self.reg(kStat), kI2CxSTAT["TBF"], false);
        state.byte_sent = true;
        const bool writes = state.open.kind == I2cPhaseKind::Write;  // both send: SDA is the and of it
        const auto sent = static_cast<std::uint8_t>(self.reg(kTrn) & (writes ? state.open.byte : kIdleLine));
        // Of a byte in step with the master's its ninth clock is high; else it is still to come.
        const bool goes_on = writes ? state.open.ack == cosim::kBehindNinthClock : state.open.ack != 0;
        self.answer(state.released - state.open.start, !writes, sent);
        if (!goes_on)
            state.ended_due = self.clock_.first_cycle_at(state.released + clocks(state.open, kByteClocks));
    } else if (state.step_due <= due && state.step == Step::Answer) {
        self.eighth_clock(due);
    }
    if (state.shown_due <= due) {
        state.shown_due = kNoCycle;
        self.show(state.shows_address, state.shown, due);
    }
    if (state.ended_due <= due) self.not_acknowledged();
    self.plan();
}

void I2cSlave::plan() {
    around_.events.schedule(slot_, std::min({state_.step_due, state_.shown_due, state_.ended_due}));
}

void I2cSlave::load(std::uint16_t value) {
    std::uint16_t& stat = reg(kStat);
    if (stat & kI2CxSTAT["TBF"]) {
        stat |= kI2CxSTAT["IWCOL"];
        return;
    }
    reg(kTrn) = value & 0xFF;
    stat |= kI2CxSTAT["TBF"] | kI2CxSTAT["D_A"];
}

void I2cSlave::control_written(std::uint16_t old) {
    std::uint16_t& con = reg(kCon);
    // Without STREN the program can only let go.
    if (!(con & kI2CxCON["STREN"]) && (old & kI2CxCON["SCLREL"])) con |= kI2CxCON["SCLREL"];
    if ((old & kI2CxCON["I2CEN"]) && !(con & kI2CxCON["I2CEN"])) return reset();
    if (!(con & kI2CxCON["SCLREL"]) || (old & kI2CxCON["SCLREL"])) return;
    const Time free = clock_.time_of(around_.now + 1);
    if (state_.step == Step::Hold) {
        let_go(free);
    } else if (state_.step == Step::Stretch) {
        const Time eighth = state_.open.start + clocks(state_.open, kAnswerClocks);
        answer(std::max<Time>(0, free - eighth), state_.acknowledge, kIdleLine);
    }
    plan();
}

Time I2cSlave::earliest_answer(Cycle now) const {
    switch (state_.step) {
    case Step::None:
        break;
    case Step::Answer:
    case Step::Shift:
        return clock_.time_of(state_.step_due);
    case Step::Stretch:
        return clock_.time_of(now + 1);
    case Step::Hold:
        if (state_.shown_due != kNoCycle)  // with a byte loaded by then nothing is held
            return clock_.time_of(
                std::max(now, cycle_before(state_.open.start + clocks(state_.open, kAnswerClocks))));
        return clock_.time_of(now + 1) + clocks(state_.open, kAnswerClocks);
    }
    return cosim::kNever;
}

}  // namespace puckloop::dspic
