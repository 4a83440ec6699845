// How faults reach the bus: a byte that suffers, a line that is held low, transfers that nobody ends.

#include "cosim/i2c/i2c_bus.h"

#include <algorithm>

namespace puckloop::cosim {

/// Sets what is pending and returns the byte as the devices see it; `heard`: they take it.
I2cPhase I2cBusNode::begin_phase(PortIndex port, const I2cPhase& phase, Time earliest, bool& heard) {
    pending_ = Pending{port, phase, earliest, {}, {}, {}, 0};
    if (faults_.empty()) return phase;
    I2cDamage damage = faults_.strike(port, phase);
    Pending& pending = *pending_;
    pending.phase.clock_period = damage.phase.clock_period;
    pending.answer.acknowledge = damage.acknowledged;
    pending.answer.byte = static_cast<std::uint8_t>(~damage.low);
    pending.flipped = damage.flipped;
    pending.lost = damage.lost;
    pending.busy_until = damage.busy_until;
    if (damage.second_device) take_answer({true, damage.value, 0}, {});
    if (damage.reset) reset_devices(phase.start);
    if (damage.stopped || damage.restarted)
        release_devices(phase.start, damage.stopped ? Ending::Stop : Ending::RepeatedStart,
                        damage.phase.byte);
    if (damage.restarted) {
        pending.addresses = true;
        damage.phase.kind = I2cPhaseKind::Start;
    }
    if (damage.hold > 0) hold_line(damage.phase, damage.hold);
    heard = !damage.refused;
    return damage.phase;
}

/// SCL stays low for `time` behind the eighth clock, as a device's stretch.
void I2cBusNode::hold_line(const I2cPhase& phase, Time time) {
    pending_->open.push_back(kFault);
    line_released_ = later(ninth_clock(phase) - std::max(phase.clock_period, nominal_period_), time);
}

void I2cBusNode::line_released() {
    line_released_ = kNever;
    I2cPhase released;
    if (std::erase(holders_, kFault) != 0) return let_go(released);
    if (!pending_ || std::erase(pending_->open, kFault) == 0) return;
    const Time ninth = std::max(pending_->phase.clock_period, nominal_period_);
    take_answer({false, 0xFF, std::max<Time>(0, now_ + ninth - ninth_clock(pending_->phase))}, {});
    settle();
}

/// The addressed devices lose power for a moment: they let the lines go and forget their registers.
void I2cBusNode::reset_devices(Time now) {
    emitted_at_ = now + nominal_period_;
    for (I2cSlave* slave : addressed_)
        slave->reset(emit_);
    addressed_.clear();
    release_devices(now, Ending::Reset);  // those in other nodes only forget the transfer
}

/// The bus is free. True if a fault begins a transfer, one that nobody will end.
bool I2cBusNode::begin_incomplete() {
    const auto transfer = faults_.take_incomplete(now_);
    if (!transfer) return false;
    for (const Contender& contender : waiting_)
        if (!options_.masters[contender.port].waits) lose(contender.port, contender.phase);
    std::erase_if(waiting_, [this](const Contender& other) { return !options_.masters[other.port].waits; });
    bus_ = Bus::Owned;
    owner_ = kFault;
    incomplete_byte_ = transfer->with_byte;
    pending_ = Pending{};
    pending_->master = kFault;
    pending_->phase = {I2cPhaseKind::Start, transfer->address_byte, 1, now_, nominal_period_, 0};
    pending_->addresses = true;
    offer_address(pending_->phase);
    settle();
    return true;
}

/// Nobody clocks the acknowledge of the transfer's last byte: who pulls SDA low goes on doing so.
void I2cBusNode::go_on_incomplete(bool acknowledged) {
    const bool last = !std::exchange(incomplete_byte_, false);
    if (acknowledged && last) return sda_held();
    if (!acknowledged) {
        bus_ = Bus::Recovering;  // SDA is high, and so is SCL: whoever comes next begins with a START
        changes_ = now_ + nominal_period_;
        return;
    }
    pending_ = Pending{};
    pending_->master = kFault;
    pending_->phase = {I2cPhaseKind::Write, 0, 1, now_ + nominal_period_, nominal_period_, 0};
    for (const PortIndex device : addressed_devices_) {
        pending_->open.push_back(device);
        answers_.push_back({pending_->phase.start + told_after(device), device, pending_->phase});
    }
    for (I2cSlave* slave : addressed_)
        take_answer(slave->write(0, pending_->phase.start), {});
    settle();
}

}  // namespace puckloop::cosim
