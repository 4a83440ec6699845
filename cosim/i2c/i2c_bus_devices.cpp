// The devices' side of the I2C bus: who is addressed, what several answers become on the wires, a stuck bus.

#include "cosim/i2c/i2c_bus.h"
#include "cosim/i2c/i2c_figures.h"
#include "cosim/i2c/i2c_shared.h"

#include <algorithm>

namespace puckloop::cosim {

namespace {
constexpr Time kRecoveryClocks = 10;          // nine for the device, one for the STOP
constexpr Time kHalfClocksBeforeAnswer = 15;  // of the sixteen before the ninth clock
constexpr unsigned kLastBit = 1;

/// A general call, and the first byte of a ten-bit address.
bool is_for_several(std::uint8_t address_byte) {
    return address_byte == 0 || (address_byte & 0xF8) == 0xF0;
}

bool contains(const std::vector<std::uint8_t>& list, std::uint8_t value) {
    return std::find(list.begin(), list.end(), value) != list.end();
}
}  // namespace

const std::string& I2cBusNode::device_name(PortIndex port) const {
    static const std::string kLine = "a fault";
    return port == kFault ? kLine : options_.devices[port - options_.masters.size()].name;
}

Time I2cBusNode::told_after(PortIndex device) const {
    return half_clock() *
           (options_.devices[device - options_.masters.size()].prompt ? kHalfClocksBeforeAnswer : 1);
}

bool I2cBusNode::own_master(PortIndex device, PortIndex master) const {
    return options_.devices[device - options_.masters.size()].master == master;
}

/// The transfer under way is one of the device's own chip.
bool I2cBusNode::own_transfer(PortIndex device) const {
    return own_master(device, owner_) || std::any_of(sharers_.begin(), sharers_.end(), [&](PortIndex master) {
               return own_master(device, master);
           });
}

/// A START with this address byte reaches the device.
bool I2cBusNode::informed_of(PortIndex device, std::uint8_t address_byte) const {
    const auto& addresses = options_.devices[device - options_.masters.size()].addresses;
    return addresses.empty() || contains(addresses, static_cast<std::uint8_t>(address_byte >> 1));
}

bool I2cBusNode::awaits_devices() const {
    const auto others = [](const std::vector<PortIndex>& ports) {
        return std::any_of(ports.begin(), ports.end(), [](PortIndex port) { return port != kFault; });
    };
    return others(holders_) || (pending_ && others(pending_->open));
}

void I2cBusNode::address(PortIndex port, const I2cPhase& phase, Time earliest) {
    ++counters_.transfers;
    read_ = (phase.byte & kReadBit) != 0;
    finished_ = false;
    log_.addressed(now_, port, phase.byte);
    bool heard = true;
    const I2cPhase seen = begin_phase(port, phase, earliest, heard);
    pending_->addresses = true;
    if (heard) offer_address(seen);
    settle();
}

/// All devices look whether they are meant.
void I2cBusNode::offer_address(const I2cPhase& seen) {
    const auto wanted = static_cast<std::uint8_t>(seen.byte >> 1);
    for (const auto& slave : slaves_)
        if (slave->listens_to(wanted)) {
            const I2cAnswer reply = slave->start((seen.byte & kReadBit) != 0, seen.start);
            if (reply.acknowledge) addressed_.push_back(slave.get());
            take_answer(reply, std::string(slave->name()));
        }
    for (std::size_t i = 0; i < options_.devices.size(); ++i) {
        const auto device = static_cast<PortIndex>(options_.masters.size() + i);
        if (!informed_of(device, seen.byte)) continue;
        if (own_transfer(device)) continue;
        answers_.push_back({std::max(seen.start + told_after(device), pending_->earliest), device, seen});
        pending_->open.push_back(device);
    }
}

void I2cBusNode::byte_from(PortIndex port, const I2cPhase& phase) {
    const bool write = phase.kind == I2cPhaseKind::Write;
    ++(write ? counters_.bytes_written : counters_.bytes_read);
    bool heard = true;
    const I2cPhase seen = begin_phase(port, phase, 0, heard);
    if (pending_->addresses) {
        offer_address(seen);
    } else if (heard) {
        for (const PortIndex device : addressed_devices_) {
            pending_->open.push_back(device);
            answers_.push_back({seen.start + told_after(device), device, seen});
        }
        for (I2cSlave* slave : addressed_)
            ask_device(*slave, seen);
        const bool refuses = write ? phase.ack != kBehindNinthClock : phase.ack == 0;
        finished_ = finished_ || (read_ && refuses);
    }
    settle();
}

/// Who sends was agreed with the address, whatever the master does now.
void I2cBusNode::ask_device(I2cSlave& slave, const I2cPhase& seen) {
    const bool write = seen.kind == I2cPhaseKind::Write;
    if (read_ && finished_) return;
    if (!read_) {
        I2cAnswer reply = slave.write(write ? seen.byte : kReleased, seen.start);
        reply.byte = kReleased;
        return take_answer(reply, {});
    }
    I2cAnswer reply = slave.read(seen.start);
    if (write) reply.acknowledge = false;
    take_answer(reply, {});
}

/// The byte read before was the last one, as its master says now.
void I2cBusNode::not_acknowledged(const I2cPhase& phase) {
    finished_ = true;
    for (const PortIndex device : addressed_devices_)
        if (!is_prompt(device)) answers_.push_back({phase.start + told_after(device), device, phase});
}

/// One more device has answered what is pending: both lines are low if any device pulls them low.
void I2cBusNode::take_answer(const I2cAnswer& reply, const std::string& name) {
    I2cAnswer& together = pending_->answer;
    together.acknowledge = together.acknowledge || reply.acknowledge;
    together.byte &= reply.byte;
    together.stretch = std::max(together.stretch, reply.stretch);
    if (!reply.acknowledge || name.empty()) return;
    pending_->who += (pending_->count++ == 0 ? "" : ", ") + name;
}

void I2cBusNode::device_answered(PortIndex port, const I2cPhase& phase, Time now) {
    if (std::erase(holders_, port) != 0) return let_go(phase);
    if (!pending_ || std::erase(pending_->open, port) == 0) return;
    const bool start = pending_->addresses;
    const bool read = pending_->phase.kind == I2cPhaseKind::Read && !start;
    const bool both_send = read_ && pending_->phase.kind == I2cPhaseKind::Write && !start;
    I2cAnswer reply{phase.ack != 0, read || both_send ? phase.byte : kReleased, 0};
    const Time ninth = std::max(pending_->phase.clock_period, nominal_period_);
    reply.stretch = std::max<Time>(0, now + ninth - ninth_clock(pending_->phase));
    if (start && reply.acknowledge) addressed_devices_.push_back(port);
    take_answer(reply, start ? device_name(port) : std::string());
    settle();
}

/// Answers the master once everybody has answered.
void I2cBusNode::settle() {
    if (!pending_->open.empty()) return;
    if (pending_->phase.kind == I2cPhaseKind::Data) return go_on_loose();
    if (pending_->phase.kind == I2cPhaseKind::Acknowledge) return settle_first_bit();
    Pending done = *pending_;
    pending_.reset();
    if (done.master == kFault) return go_on_incomplete(done.answer.acknowledge);
    if (done.count > 1 && !is_for_several(done.phase.byte)) {
        Crowd& crowd = crowds_[static_cast<std::uint8_t>(done.phase.byte >> 1)];
        ++crowd.times;
        crowd.names = done.who;
        log_.crowded(now_, done.phase.byte, done.who, crowd.times);
    }
    if (announce_ && done.addresses) {
        announce_ = false;
        I2cPhase notice = done.phase;
        notice.kind = kSharedNotice;
        for (const PortIndex port : sharers_)
            answers_.push_back(
                {std::max(ninth_clock(done.phase), done.earliest) + done.answer.stretch, port, notice});
    }
    if (done.lost) {
        answer_masters(done, I2cPhaseKind::BusLost, {false, kReleased, done.answer.stretch});
        bus_ = Bus::Recovering;  // until the STOP of whoever has it now
        changes_ = std::max(done.busy_until, now_ + nominal_period_);
        return;
    }
    const bool both_send = done.phase.kind == I2cPhaseKind::Write && read_;
    const bool behind_ninth = both_send && done.phase.ack == kBehindNinthClock;
    const auto driven = static_cast<std::uint8_t>(done.phase.byte & (behind_ninth ? ~kLastBit : ~0));
    if (behind_ninth) done.answer.acknowledge = (done.answer.byte & kLastBit) == 0;
    if (both_send && (driven & ~done.answer.byte) != 0) {
        answer_masters(done, I2cPhaseKind::BusLost, {false, kReleased, done.answer.stretch});
        return sda_held();  // nobody clocks the rest of the byte
    }
    done.answer.byte ^= done.flipped;
    const bool read = done.phase.kind == I2cPhaseKind::Read;
    if (read && !sharers_.empty()) return answer_readers(done);
    answer_masters(done, read ? I2cPhaseKind::Data : I2cPhaseKind::Acknowledge, done.answer);
}

/// One, or all that share the bus.
void I2cBusNode::answer_masters(const Pending& done, I2cPhaseKind kind, const I2cAnswer& reply) {
    const std::vector<PortIndex> masters = sharers_.empty() ? std::vector{done.master} : sharers_;
    for (const PortIndex port : masters) {
        if (kind == I2cPhaseKind::BusLost)
            lose(port, done.phase, reply, done.earliest);
        else
            answer(port, done.phase, kind, reply, done.earliest);
    }
    if (kind == I2cPhaseKind::BusLost) forget_sharers();
}

/// A STOP is noticed by all who watch the bus. A repeated START is none: a ten-bit address holds on. Devices
/// that are informed of the START find the end of their transfer in it, the others get a STOP in its place.
void I2cBusNode::release_devices(Time now, Ending ending, std::uint8_t address_byte) {
    I2cPhase stop;
    stop.start = now;
    for (std::size_t i = 0; i < options_.devices.size(); ++i) {
        const auto device = static_cast<PortIndex>(options_.masters.size() + i);
        const bool addressed = std::find(addressed_devices_.begin(), addressed_devices_.end(), device) !=
                               addressed_devices_.end();
        if (ending == Ending::Stop && !addressed && options_.devices[i].master && !own_transfer(device))
            answers_.push_back({now + told_after(device), device, stop});
    }
    for (const PortIndex device : addressed_devices_) {
        if (ending != Ending::RepeatedStart || !informed_of(device, address_byte))
            answers_.push_back({now + told_after(device), device, stop});
    }
    addressed_devices_.clear();
    emitted_at_ = now + nominal_period_;
    for (I2cSlave* slave : addressed_)
        slave->stop(now, emit_);
    addressed_.clear();
}

/// The owner gives up while devices hold SCL low.
void I2cBusNode::hang() {
    bus_ = Bus::Stuck;
    forget_sharers();
    holders_ = pending_->open;
    for (const PortIndex device : holders_)  // those of a Start are not addressed yet, but will want a STOP
        if (device != kFault && std::find(addressed_devices_.begin(), addressed_devices_.end(), device) ==
                                    addressed_devices_.end())
            addressed_devices_.push_back(device);
    stuck_names_.clear();
    for (const PortIndex device : holders_)
        stuck_names_ += (stuck_names_.empty() ? "" : ", ") + device_name(device);
    pending_.reset();
    stuck_since_ = now_;
    ++counters_.stuck;
    log_.stuck(now_, stuck_names_, counters_.stuck);
}

/// A device of a stuck bus has released SCL.
void I2cBusNode::let_go(const I2cPhase& phase) {
    if (!holders_.empty()) return;
    stuck_for_ += now_ - stuck_since_;
    log_.released(now_, stuck_names_);
    const bool pulls_sda = phase.kind == I2cPhaseKind::Data ? (phase.byte & kFirstBit) == 0 : phase.ack != 0;
    if (pulls_sda) return sda_held();
    bus_ = Bus::Recovering;  // nothing to wait for but the STOP
    changes_ = now_ + nominal_period_;
}

/// A device in the middle of a byte holds SDA low.
void I2cBusNode::sda_held() {
    bus_ = Bus::HeldLow;
    if (std::any_of(waiting_.begin(), waiting_.end(),
                    [this](const Contender& contender) { return options_.masters[contender.port].waits; }))
        recover(now_);
}

void I2cBusNode::recover(Time from) {
    bus_ = Bus::Recovering;
    changes_ = from + kRecoveryClocks * nominal_period_;
}

}  // namespace puckloop::cosim
