// A master whose clocks are not those of whole bytes: it leaves out ninth clocks or gives too many, or makes
// a STOP or a START where devices are to send. What is on the wires decides, clock by clock (UM10204, 3.1.4
// to 3.1.6).

#include "cosim/i2c/i2c_bus.h"
#include "cosim/i2c/i2c_figures.h"
#include "cosim/i2c/i2c_shared.h"

#include <utility>

namespace puckloop::cosim {

namespace {
constexpr int kLastBitPlace = kBitsOfByte - 1, kNinthPlace = kBitsOfByte;
}  // namespace

/// A 1 of the master's, its STOP or its START meets a low SDA, and nobody clocks on.
void I2cBusNode::in_the_way() {
    const Pending done = *std::exchange(pending_, std::nullopt);
    lose(done.master, done.phase, {false, kReleased, done.answer.stretch}, done.earliest);
    sda_held();
}

/// A STOP or repeated START comes where devices send: what their next bit is. A device in this node that is
/// asked for it has the byte in its shift register, and drops it with the STOP.
void I2cBusNode::ask_first_bit(PortIndex port, const I2cPhase& phase) {
    pending_ = Pending{port, phase, 0, {}, {}, {}, 0};
    if (read_ && !finished_) {
        for (const PortIndex device : addressed_devices_) {
            if (is_prompt(device)) continue;
            pending_->open.push_back(device);
            answers_.push_back({phase.start + told_after(device), device, phase});
        }
        for (I2cSlave* slave : addressed_) {
            const I2cAnswer next = slave->read(phase.start);
            take_answer({(next.byte & kFirstBit) == 0, kReleased, next.stretch}, {});
        }
    }
    settle();
}

void I2cBusNode::settle_first_bit() {
    if (pending_->answer.acknowledge) return in_the_way();
    const Pending done = *std::exchange(pending_, std::nullopt);
    I2cPhase high = done.phase;
    high.ack = 0;
    high.stretch = done.answer.stretch;
    answers_.push_back({ninth_clock(done.phase) + done.answer.stretch, done.master, high});
}

void I2cBusNode::begin_loose(PortIndex port, const I2cPhase& phase) {
    pending_ = Pending{port, phase, 0, {}, {}, {}, 0};
    go_on_loose();
}

/// Devices that receive find the ones and zeros of the next clocks in their byte, wherever it is.
void I2cBusNode::go_on_loose() {
    Pending& pending = *pending_;
    const LooseClocks clocks = LooseClocks::of(pending.phase.ack);
    if (pending.clocked > 0) held_ = std::exchange(pending.answer.acknowledge, false);  // they have answered
    while (pending.clocked < clocks.count) {
        const int clock = pending.clocked++, place = (clocks.before + clock) % LooseClocks::kClocks;
        const bool let_go = clock == kNinthPlace;
        const bool drives = let_go || (pending.phase.byte << clock & kFirstBit) != 0;
        const bool low = !drives || (place == kNinthPlace && held_);
        if (place == kNinthPlace) held_ = false;
        if (low && drives && !let_go && clocks.drives()) return in_the_way();
        if (let_go)
            pending.ninth_low = low;
        else if (low)
            pending.line = static_cast<std::uint8_t>(pending.line & ~(kFirstBit >> clock));
        if (place == 0) loose_bits_ = 0;
        if (place < kNinthPlace) loose_bits_ = static_cast<std::uint8_t>(loose_bits_ << 1 | (low ? 0 : 1));
        if (place == kLastBitPlace && ask_loose()) return;
    }
    const Pending done = *std::exchange(pending_, std::nullopt);
    if (!clocks.answered()) return;
    I2cPhase line = done.phase;
    line.byte = done.line;
    line.ack = static_cast<std::uint8_t>((done.ninth_low ? LooseClocks::kLineLow : 0) |
                                         (held_ ? LooseClocks::kHeldLow : 0));
    line.stretch = done.answer.stretch;
    answers_.push_back({ninth_clock(done.phase) + done.answer.stretch, done.master, line});
}

/// The eighth bit of the devices' byte is in: do they acknowledge it? True if they are yet to answer.
bool I2cBusNode::ask_loose() {
    ++counters_.bytes_written;
    I2cPhase seen = pending_->phase;
    seen.kind = I2cPhaseKind::Write;
    seen.byte = loose_bits_;
    seen.ack = 0;
    if (!read_) {
        for (const PortIndex device : addressed_devices_) {
            pending_->open.push_back(device);
            answers_.push_back({seen.start + told_after(device), device, seen});
        }
        for (I2cSlave* slave : addressed_)
            take_answer(slave->write(seen.byte, seen.start), {});
    }
    if (!pending_->open.empty()) return true;
    held_ = std::exchange(pending_->answer.acknowledge, false);
    return false;
}

}  // namespace puckloop::cosim
