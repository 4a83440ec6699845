#include "emu/avr/peripherals/serial/twi.h"

#include "emu/avr/peripherals/shared_registers.h"

#include "cosim/i2c/i2c_shared.h"

#include <utility>

namespace puckloop::avr {

namespace {

using PhaseKind = cosim::I2cPhaseKind;

constexpr int kTwiVector = 26;
constexpr std::uint16_t kTwbr = 0xB8, kTwsr = 0xB9, kTwar = 0xBA, kTwdr = 0xBB, kTwcr = 0xBC, kTwamr = 0xBD;
constexpr std::uint8_t kPrtwi = bit(7);  // PRR0
constexpr std::uint8_t kTwint = bit(7), kTwea = bit(6), kTwsta = bit(5), kTwsto = bit(4), kTwwc = bit(3),
                       kTwen = bit(2), kTwie = bit(0);
constexpr std::uint8_t kTwps = 0x03, kTwgce = bit(0), kRead = bit(0);
constexpr Pin kScl{PortLetter::C, 0}, kSda{PortLetter::C, 1};

// TWSR7:3
constexpr std::uint8_t kStarted = 0x08, kRepeated = 0x10, kIdle = 0xF8, kLost = 0x38;
constexpr std::uint8_t kMtAddressAck = 0x18, kMtAddressNack = 0x20, kMtDataAck = 0x28, kMtDataNack = 0x30;
constexpr std::uint8_t kMrAddressAck = 0x40, kMrAddressNack = 0x48, kMrDataAck = 0x50, kMrDataNack = 0x58;
constexpr std::uint8_t kSrAddress = 0x60, kSrGeneral = 0x70, kSrDataAck = 0x80, kSrDataNack = 0x88,
                       kSrGeneralAck = 0x90, kSrGeneralNack = 0x98, kSrStop = 0xA0;
constexpr std::uint8_t kStAddress = 0xA8, kStDataAck = 0xB8, kStDataNack = 0xC0, kStLastAck = 0xC8;
/// Addressed after arbitration was lost; a bus error.
constexpr std::uint8_t kLostSrAddress = 0x68, kLostSrGeneral = 0x78, kLostStAddress = 0xB0, kBusError = 0x00;
constexpr int kAnswerClocks = 8;
constexpr int kClocksOfByte = 9;
constexpr std::uint8_t kReleased = 0xFF, kFirstBit = 0x80;  // kReleased: a byte that nobody drives
constexpr unsigned kAddresses = 128;

}  // namespace

Twi::Twi(const Surroundings& around, const cosim::ClockDomain& clock, Ports& ports, Pins& pins)
    : around_(around), clock_(clock), ports_(ports), pins_(pins), slot_(around.events.add(this, &due)) {
    around_.io.claim(kTwbr);
    around_.io.claim(kTwar);
    around_.io.claim(kTwamr);
    around_.io.hook(kTwsr, this, nullptr, &write_status);
    around_.io.hook(kTwdr, this, nullptr, &write_data);
    around_.io.hook(kTwcr, this, nullptr, &write_control);
    around_.interrupts.connect(kTwiVector, this, nullptr);
}

// A master whose byte is under way, or waits for this unit to let SCL go, finds nobody for the rest of it.
void Twi::reset() {
    const State old = state_;
    const bool open = old.slave_waits || old.step == Step::SlaveAnswer;
    const Cycle over = old.step == Step::SlaveAnswer ? around_.events.due(slot_) : 0;
    state_ = {};
    around_.events.cancel(slot_);
    if (!open) return;
    state_.phase = old.phase;
    state_.bus_taken = true;
    if (old.slave_waits)
        begin_slave_phase();
    else
        plan(Step::SlaveAnswer, over);
}

Cycle Twi::period() const {
    return 16 + 2 * Cycle{around_.io.raw(kTwbr)} * (Cycle{1} << (2 * (status() & kTwps)));
}

void Twi::plan(Step step, Cycle at) {
    state_.step = step;
    around_.events.schedule(slot_, at);
}

void Twi::update_request() {
    around_.interrupts.request(kTwiVector, (control() & kTwint) && (control() & kTwie));
}

/// TWSR holds a status while TWINT is set, at all other times 0xF8.
void Twi::show_status(std::uint8_t code) {
    status() = static_cast<std::uint8_t>((status() & kTwps) | code);
}

void Twi::interrupt(std::uint8_t code) {
    state_.code = code;
    show_status(code);
    control() |= kTwint;
    update_request();
}

// ---- registers

void Twi::write_status(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t mask) {
    auto& self = *static_cast<Twi*>(owner);
    self.status() = merged(self.status(), value, mask & kTwps);
}

// TWDR can only be written while TWINT is set.
void Twi::write_data(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Twi*>(owner);
    const bool writable = self.control() & kTwint;
    if (writable) self.data() = value;
    assign(self.control(), kTwwc, !writable);
}

void Twi::write_control(void* owner, std::uint16_t, std::uint8_t value, std::uint8_t) {
    auto& self = *static_cast<Twi*>(owner);
    if (!self.powered()) return;
    const std::uint8_t old = self.control();
    constexpr std::uint8_t kKept = kTwwc;
    const bool cleared = value & kTwint;
    self.control() = static_cast<std::uint8_t>((value & (kTwea | kTwsta | kTwsto | kTwen | kTwie)) |
                                               (old & kKept) | (cleared ? 0 : old & kTwint));
    if (cleared) self.show_status(kIdle);
    if ((old ^ value) & kTwen) {
        if (value & kTwen) {
            self.ports_.override_value(kScl, true, PinUser::Serial);
            self.ports_.override_value(kSda, true, PinUser::Serial);
            // Open drain: the lines are the bus's.
            self.ports_.override_direction(kScl, false);
            self.ports_.override_direction(kSda, false);
        } else {  // whatever was going on is given up
            self.ports_.release_value(kScl, PinUser::Serial);
            self.ports_.release_value(kSda, PinUser::Serial);
            self.ports_.release_direction(kScl);
            self.ports_.release_direction(kSda);
            if (self.state_.owner) self.begin_phase(PhaseKind::Stop, 0, false);
            const bool taken = self.state_.bus_taken;
            self.reset();
            self.state_.bus_taken = self.state_.bus_taken || taken;
            self.show_status(kIdle);
        }
    }
    self.update_request();
    if (!(value & kTwen)) return;
    // Clearing TWINT starts the next operation; START and STOP may also be asked for while the bus is idle.
    if (cleared || ((value & (kTwsta | kTwsto)) && !(self.control() & kTwint))) self.go_on();
}

// ---- master

void Twi::begin_phase(PhaseKind kind, std::uint8_t byte, bool acknowledge) {
    cosim::I2cPhase& phase = state_.phase;
    phase = {};
    phase.kind = kind;
    phase.byte = byte;
    phase.ack = acknowledge;
    phase.start = clock_.time_of(around_.now + 1);
    phase.clock_period = clock_.time_of(around_.now + 1 + period()) - phase.start;
    state_.first_bit_asked = false;
    state_.awaiting = kind != PhaseKind::Stop;
    pins_.twi_phase(phase);
}

bool Twi::powered() const {
    return !(around_.io.raw(kPrr0) & kPrtwi);
}

// START once the bus is free; a repeated one at once.
void Twi::start(bool repeated, Cycle now) {
    state_.next_status = repeated ? kRepeated : kStarted;
    state_.start_waits = state_.bus_taken && !repeated;
    if (!state_.start_waits) plan(Step::StartSent, now + period());
}

// Another master sent STOP: who waited for the bus may have it half a period later.
void Twi::bus_free() {
    state_.bus_taken = false;
    if (!state_.start_waits) return;
    state_.start_waits = false;
    start(false, around_.now + period() / 2);
}

void Twi::go_on() {
    if ((state_.slave || state_.stop_waits) && (control() & kTwsto)) return leave_slave();
    if (state_.stop_waits) {
        state_.stop_waits = false;
        return interrupt(kSrStop);
    }
    if (state_.slave) {
        if (state_.slave_waits) begin_slave_phase();
        return;
    }
    if (state_.step == Step::SlaveAnswer) {  // a byte in which this unit has no part any more
        assign(control(), kTwsto, false);
        state_.start_waits = control() & kTwsta;
        return;
    }
    if (state_.awaiting || state_.step != Step::None) return;  // an operation is under way
    const Cycle next = around_.now + 1;
    if ((control() & (kTwsto | kTwsta)) && asks_first_bit()) return;
    if (control() & (kTwsto | kTwsta)) return end_transfer(next);
    state_.start_waits = false;
    if (!state_.owner) return;
    switch (state_code()) {
    case kStarted:
    case kRepeated:
        return begin_phase(PhaseKind::Start, data(), false);
    case kMtAddressAck:
    case kMtAddressNack:
    case kMtDataAck:
    case kMtDataNack:
        return begin_phase(PhaseKind::Write, data(), false);
    case kMrAddressAck:
    case kMrDataAck:
        return begin_phase(PhaseKind::Read, 0, control() & kTwea);
    default:
        return;
    }
}

/// STOP, or else a START.
void Twi::end_transfer(Cycle next) {
    if (!(control() & kTwsto)) return start(state_.owner, next);
    if (state_code() == kBusError) state_.owner = false;  // the lines are released, without a STOP
    const bool waits = state_.owner && state_.shared;     // SCL rises when the other master lets it
    if (state_.owner) begin_phase(PhaseKind::Stop, 0, false);
    state_.awaiting = waits;
    if (waits) return;
    plan(Step::StopSent, next + period());
}

/// Where a slave is to send its next byte the first bit of it is on SDA.
bool Twi::asks_first_bit() {
    const unsigned code = state_code();
    if (!state_.owner || state_.shared || (code != kMrAddressAck && code != kMrDataAck)) return false;
    begin_phase(PhaseKind::Acknowledge, 0, true);  // kNoByteFollows
    state_.first_bit_asked = true;
    return true;
}

void Twi::answer(const cosim::I2cPhase& phase) {
    if (!state_.awaiting) return;
    if (std::exchange(state_.first_bit_asked, false) && phase.kind != PhaseKind::BusLost) {
        state_.awaiting = false;
        return end_transfer(around_.now);
    }
    if (phase.kind == cosim::kSharedNotice) {
        state_.shared = true;
        return;
    }
    const bool is_byte = state_.phase.kind != PhaseKind::Stop && state_.phase.kind != PhaseKind::Acknowledge;
    if (phase.kind == PhaseKind::BusLost && is_byte && state_.step == Step::None) {
        const Cycle over = clock_.first_cycle_at(state_.phase.start) + kClocksOfByte * period();
        if (over > around_.now) return answer_at(phase, over);
    }
    state_.awaiting = false;
    if (phase.kind == PhaseKind::BusLost) state_.shared = false;
    if (!is_byte && phase.kind != PhaseKind::BusLost) return plan(Step::StopSent, around_.now);
    const bool reads = state_.phase.byte & kRead;
    switch (state_.phase.kind) {
    case PhaseKind::Start:
        if (!phase.ack && phase.kind != PhaseKind::BusLost) {
            const unsigned address = state_.phase.byte >> 1;
            refused_[address / 64] |= std::uint64_t{1} << address % 64;
        }
        state_.next_status = reads ? (phase.ack ? kMrAddressAck : kMrAddressNack)
                                   : (phase.ack ? kMtAddressAck : kMtAddressNack);
        break;
    case PhaseKind::Write:
        state_.next_status = phase.ack ? kMtDataAck : kMtDataNack;
        break;
    default:
        state_.next_status = state_.phase.ack ? kMrDataAck : kMrDataNack;
        if (is_byte) data() = phase.byte;
        break;
    }
    if (phase.kind == PhaseKind::BusLost) {
        if (is_byte) data() = phase.byte;  // shifted in as by a slave
        state_.next_status = kLost;
        assign(control(), kTwsto, false);
    }
    if (state_.next_status == kLost) state_.owner = false;
    interrupt(state_.next_status);
}

std::vector<std::uint8_t> Twi::refused() const {
    std::vector<std::uint8_t> addresses;
    for (unsigned address = 0; address < kAddresses; ++address)
        if (refused_[address / 64] >> address % 64 & 1u)
            addresses.push_back(static_cast<std::uint8_t>(address));
    return addresses;
}

void Twi::answer_at(const cosim::I2cPhase& phase, Cycle at) {
    if (!state_.awaiting) return;
    state_.answer = phase;
    plan(Step::Answer, at);
}

void Twi::due(void* owner, Cycle cycle) {
    auto& self = *static_cast<Twi*>(owner);
    State& st = self.state_;
    const Step step = st.step;
    st.step = Step::None;
    switch (step) {
    case Step::StartSent:
        st.owner = true;
        self.interrupt(st.next_status);
        break;
    case Step::StopSent:
        st.owner = st.shared = false;
        assign(self.control(), kTwsto, false);
        st.code = kIdle;
        self.show_status(kIdle);
        if (self.control() & kTwsta) self.start(false, cycle);
        break;
    case Step::SlaveAnswer:
        self.finish_slave_phase(cycle);
        break;
    case Step::SlavePhaseOver:
        // Who did not acknowledge, or sent his last byte, is no longer addressed.
        if (st.next_status == kSrDataNack || st.next_status == kSrGeneralNack ||
            st.next_status == kStDataNack || st.next_status == kStLastAck)
            st.slave = false;
        self.interrupt(st.next_status);
        break;
    case Step::Answer:
        self.answer(st.answer);
        break;
    case Step::None:
        break;
    }
}

// ---- slave

bool Twi::addressed(std::uint8_t address_byte, bool& general_call) const {
    if (!(control() & kTwen)) return false;
    if (state_code() == kBusError && (control() & kTwint)) return false;
    const std::uint8_t own = around_.io.raw(kTwar), ignored = around_.io.raw(kTwamr);
    general_call = address_byte == 0 && (own & kTwgce);
    return general_call || (((address_byte ^ own) & 0xFE & ~ignored) == 0);
}

Cycle Twi::slave_clocks(int clocks, const cosim::I2cPhase& phase) const {
    const cosim::Time span = static_cast<cosim::Time>(clocks) * phase.clock_period;
    return clock_.first_cycle_at(clock_.time_of(around_.now) + span) - around_.now;
}

void Twi::slave_phase(const cosim::I2cPhase& phase) {
    if (state_.step == Step::SlavePhaseOver) {  // it ends in this clock
        around_.events.cancel(slot_);
        due(this, around_.now);
    }
    // The ninth clock of a byte: the masters of this unit state it with the Read.
    if (phase.kind == PhaseKind::Acknowledge && phase.ack == 0) return;
    const bool was_slave = state_.slave;
    const bool ends = phase.kind == PhaseKind::Stop || phase.kind == PhaseKind::Start;
    state_.lost = false;
    const bool in_address = around_.now < std::exchange(state_.address_ends, Cycle{0});
    if (ends && state_.step == Step::SlaveAnswer && !was_slave) {  // a byte that TWSTO has left
        around_.events.cancel(slot_);
        state_.step = Step::None;
    }
    if (ends && (in_address || state_.step == Step::SlaveAnswer)) return bus_error(phase);
    if (state_.awaiting && ends) {
        state_.awaiting = state_.owner = false;
        around_.events.cancel(slot_);
        state_.step = Step::None;
        state_.lost = phase.kind == PhaseKind::Start && state_.phase.kind == PhaseKind::Start;
        if (!state_.lost) interrupt(kBusError);
    }
    if (phase.kind == PhaseKind::Start) {
        state_.bus_taken = true;
        if (state_.step == Step::StartSent && !state_.owner) {  // the other was quicker
            state_.step = Step::None;
            around_.events.cancel(slot_);
            state_.start_waits = true;
        }
    }
    if (phase.kind == PhaseKind::Stop || phase.kind == PhaseKind::Start) {
        state_.slave = state_.slave_waits = false;
        const bool hears_stop =
            was_slave && state_code() < kStAddress;  // a receiver does, repeated START too
        state_.stop_waits = hears_stop && (control() & kTwint);
        if (hears_stop && !state_.stop_waits) interrupt(kSrStop);
        if (phase.kind == PhaseKind::Stop) return bus_free();
        // TWEA counts when the byte is over; a program that serves the STOP before has until then.
        state_.slave = addressed(phase.byte, state_.general_call) &&
                       ((control() & kTwea) || state_.stop_waits || hears_stop);
        state_.sends = phase.byte & kRead;
        if (state_.lost && !state_.slave) interrupt(kLost);
        if ((control() & kTwen) && !state_.slave)
            state_.address_ends = around_.now + slave_clocks(kAnswerClocks, phase);
    }
    state_.phase = phase;
    if (!state_.slave) {
        refuse(phase);
        return;
    }
    // SCL is held low as long as TWINT is set.
    state_.slave_waits = control() & kTwint;
    if (!state_.slave_waits) begin_slave_phase();
}

Cycle Twi::earliest_slave_answer(Cycle now) const {
    if (state_.step == Step::SlaveAnswer) return around_.events.due(slot_);
    if (!state_.slave_waits) return kNoCycle;
    const cosim::Time span = kAnswerClocks * state_.phase.clock_period;
    return clock_.first_cycle_at(clock_.time_of(now) + span);
}

void Twi::begin_slave_phase() {
    state_.slave_waits = false;
    const cosim::Time late = clock_.time_of(around_.now) - state_.phase.start;
    state_.phase.stretch = late > 0 ? late : 0;
    plan(Step::SlaveAnswer, around_.now + slave_clocks(kAnswerClocks, state_.phase));
}

void Twi::finish_slave_phase(Cycle now) {
    if (!state_.slave) return refuse(state_.phase);  // TWSTO came meanwhile
    cosim::I2cPhase answer = state_.phase;
    answer.kind = PhaseKind::Acknowledge;
    switch (state_.phase.kind) {
    case PhaseKind::Start:
        if (!(control() & kTwea)) return refuse_address();
        answer.ack = 1;
        data() = state_.phase.byte;
        state_.next_status = state_.general_call           ? kSrGeneral
                             : (state_.phase.byte & kRead) ? kStAddress
                                                           : kSrAddress;
        if (state_.lost)
            state_.next_status = state_.general_call           ? kLostSrGeneral
                                 : (state_.phase.byte & kRead) ? kLostStAddress
                                                               : kLostSrAddress;
        break;
    case PhaseKind::Acknowledge:  // no byte follows: what is on SDA once SCL is free
        answer.ack = state_.sends && !(data() & kFirstBit) ? 1 : 0;
        return pins_.twi_slave_answer(answer);
    default:
        finish_slave_byte(answer);
        break;
    }
    pins_.twi_slave_answer(answer);
    plan(Step::SlavePhaseOver, now + slave_clocks(1, state_.phase));
}

/// Who sends was agreed with the address, whatever the master does.
void Twi::finish_slave_byte(cosim::I2cPhase& answer) {
    const bool writes = state_.phase.kind == PhaseKind::Write;
    if (!writes) answer.kind = PhaseKind::Data;
    if (!state_.sends) {
        answer.ack = control() & kTwea ? 1 : 0;
        data() = answer.byte = writes ? state_.phase.byte : kReleased;
        state_.next_status = state_.general_call ? (answer.ack ? kSrGeneralAck : kSrGeneralNack)
                                                 : (answer.ack ? kSrDataAck : kSrDataNack);
        return;
    }
    const bool acknowledged = !writes && state_.phase.ack;  // who writes leaves SDA high in the ninth clock
    // TWDR is the shift register: it holds what was on the line.
    data() = answer.byte = static_cast<std::uint8_t>(data() & (writes ? state_.phase.byte : kReleased));
    if (writes) answer.ack = 0;
    state_.next_status = !acknowledged ? kStDataNack : (control() & kTwea) ? kStDataAck : kStLastAck;
}

/// A START or STOP in the middle of a byte of ours. TWSTO has to be set before the unit takes part again.
void Twi::bus_error(const cosim::I2cPhase& phase) {
    around_.events.cancel(slot_);
    state_.step = Step::None;
    state_.slave = state_.slave_waits = state_.stop_waits = false;
    state_.bus_taken = phase.kind == PhaseKind::Start;
    interrupt(kBusError);
    if (phase.kind == PhaseKind::Stop) return bus_free();
    refuse(phase);
}

/// TWSTO of a slave: no STOP, but it is not addressed any more and lets go of the lines at once.
void Twi::leave_slave() {
    assign(control(), kTwsto, false);
    state_.code = kIdle;
    // A STOP or START that came meanwhile has ended it already, and the START may be for us again.
    const bool ended = std::exchange(state_.stop_waits, false);
    state_.slave = state_.slave && ended;
    if (state_.step == Step::SlavePhaseOver) {
        around_.events.cancel(slot_);
        state_.step = Step::None;
    }
    if (state_.slave_waits) begin_slave_phase();  // of a slave that has left nobody acknowledges it
    if (control() & kTwsta) start(false, around_.now + 1);
}

/// TWEA was cleared before the own address was over.
void Twi::refuse_address() {
    state_.slave = false;
    refuse(state_.phase);
    if (state_.lost) interrupt(kLost);
    if (control() & kTwsta) state_.start_waits = state_.bus_taken;
}

/// Nobody is here.
void Twi::refuse(cosim::I2cPhase phase) {
    phase.kind = phase.kind == PhaseKind::Read ? PhaseKind::Data : PhaseKind::Acknowledge;
    phase.byte = kReleased;
    phase.ack = 0;
    pins_.twi_slave_answer(phase);
}

}  // namespace puckloop::avr
