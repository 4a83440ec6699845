// Masters that made the same START with the same address byte. SCL is low until each of them has stated what
// it does next, as their hardware holds it; then the bits decide who goes on (UM10204, 3.1.8).

#include "cosim/i2c/i2c_bus.h"
#include "cosim/i2c/i2c_figures.h"
#include "cosim/i2c/i2c_shared.h"

#include <algorithm>
#include <bit>

namespace puckloop::cosim {

namespace {
/// Who has SDA low first goes on. In the first clock a STOP is low, then high; a repeated START high, then
/// low; who reads leaves SDA alone.
std::pair<int, int> turn_order(const I2cPhase& phase) {
    switch (phase.kind) {
    case I2cPhaseKind::Write:
        return {(phase.byte & kFirstBit) == 0 ? 0 : 3, phase.byte};
    case I2cPhaseKind::Stop:
        return {1, 0};
    case I2cPhaseKind::Start:
        return {2, phase.byte};
    default:
        return {4, 0};
    }
}

/// The clock in which `loser` finds SDA low that it lets go; 1 the first.
int lost_clock(const I2cPhase& loser, const I2cPhase& winner) {
    if (loser.kind != winner.kind) return 1;
    const auto differs = static_cast<std::uint8_t>(loser.byte ^ winner.byte);
    return std::min(std::countl_zero(differs) + 1, kBitsOfByte);
}
}  // namespace

bool I2cBusNode::shares(PortIndex port) const {
    return std::find(sharers_.begin(), sharers_.end(), port) != sharers_.end();
}

/// What a sharer does next. One that awaits an answer can only give up.
void I2cBusNode::turn_from(PortIndex port, const I2cPhase& phase) {
    if (phase.kind == I2cPhaseKind::Data) return;  // of a master that is alone only
    const auto is_port = [port](const Contender& other) { return other.port == port; };
    const bool has_turn = std::any_of(turns_.begin(), turns_.end(), is_port) ||
                          std::any_of(refusing_.begin(), refusing_.end(), is_port) ||
                          std::any_of(given_.begin(), given_.end(), is_port);
    if (pending_ || has_turn) {
        if (phase.kind == I2cPhaseKind::Stop) give_up(port, phase);
        return;
    }
    const bool ninth_open = std::erase(ninth_, port) != 0;
    if (phase.kind == I2cPhaseKind::Acknowledge) {
        if (!ninth_open)  // a clock that belongs to no byte
            return answer_sharer(port, phase, I2cPhaseKind::Acknowledge, phase.ack != 0, 1);
        given_.push_back({port, phase});
    } else {
        turns_.push_back({port, phase});
    }
    if (ninth_open && ninth_.empty()) decide_ninth_clock();
    take_turns();
}

void I2cBusNode::answer_sharer(PortIndex port, const I2cPhase& phase, I2cPhaseKind kind, bool low,
                               int clocks) {
    I2cPhase out = phase;
    out.kind = kind;
    out.ack = low ? 1 : 0;
    const Time begun = std::max(phase.start, now_);
    answers_.push_back({begun + clocks * std::max(phase.clock_period, nominal_period_), port, out});
}

void I2cBusNode::lose_share(PortIndex port, const I2cPhase& phase, int clocks) {
    ++counters_.lost;
    log_.lost(now_, port, phase);
    answer_sharer(port, phase, I2cPhaseKind::BusLost, false, clocks);
    drop_sharer(port);
}

void I2cBusNode::drop_sharer(PortIndex port) {
    const auto is_port = [port](const Contender& other) { return other.port == port; };
    std::erase(sharers_, port);
    std::erase(ninth_, port);
    std::erase_if(turns_, is_port);
    std::erase_if(refusing_, is_port);
    std::erase_if(given_, is_port);
    if (!sharers_.empty()) owner_ = sharers_.front();
}

/// A master that loses patience lets both lines go, the others have the bus.
void I2cBusNode::give_up(PortIndex port, const I2cPhase& phase) {
    const bool ninth_open = std::erase(ninth_, port) != 0;
    if (sharers_.size() == 1) {
        forget_sharers();
        return stop_from(port, phase);
    }
    drop_sharer(port);
    if (pending_ && pending_->master == port) pending_->master = owner_;
    if (ninth_open && ninth_.empty()) decide_ninth_clock();
    take_turns();
}

void I2cBusNode::forget_sharers() {
    sharers_.clear();
    turns_.clear();
    ninth_.clear();
    refusing_.clear();
    given_.clear();
    announce_ = false;
}

/// All sharers have stated what they do next: the bits decide.
void I2cBusNode::take_turns() {
    if (pending_ || !ninth_.empty() || turns_.empty() || turns_.size() != sharers_.size()) return;
    const std::vector<Contender> turns = std::exchange(turns_, {});
    const Contender& best =
        *std::min_element(turns.begin(), turns.end(), [](const Contender& a, const Contender& b) {
            return std::pair(turn_order(a.phase), a.port) < std::pair(turn_order(b.phase), b.port);
        });
    I2cPhase together = best.phase;
    for (const Contender& turn : turns) {
        together.start = std::max({together.start, turn.phase.start, now_});
        together.clock_period = std::max(together.clock_period, turn.phase.clock_period);
    }
    reads_.clear();
    together.ack = 0;
    for (Contender turn : turns) {
        if (turn_order(turn.phase) == turn_order(best.phase)) {
            // A receiver's acknowledge is its own; who gives it later may yet refuse.
            if (turn.phase.ack != 0) together.ack = 1;
            reads_.push_back(turn);
            continue;
        }
        const int clocks = lost_clock(turn.phase, best.phase);
        if (turn.phase.kind == best.phase.kind) turn.phase.byte = best.phase.byte;  // what it shifts in
        turn.phase.start = together.start;
        turn.phase.clock_period = together.clock_period;
        lose_share(turn.port, turn.phase, clocks);
    }
    owner_ = sharers_.front();
    switch (together.kind) {
    case I2cPhaseKind::Start:
        release_devices(together.start, Ending::RepeatedStart, together.byte);
        return address(owner_, together, 0);
    case I2cPhaseKind::Stop:
        for (const PortIndex port : sharers_)
            answer_sharer(port, together, I2cPhaseKind::Acknowledge, false, 1);
        stop_from(owner_, together);
        return forget_sharers();
    default:
        return byte_from(owner_, together);
    }
}

/// The byte that all sharers read has come. Who refuses it finds SDA low if another acknowledges.
void I2cBusNode::answer_readers(const Pending& done) {
    line_low_ = std::any_of(reads_.begin(), reads_.end(),
                            [](const Contender& reader) { return reader.phase.ack == 1; });
    byte_read_ = done.answer.byte;
    std::erase_if(reads_, [this](const Contender& reader) { return !shares(reader.port); });  // gave up
    for (const Contender& reader : reads_)
        if (reader.phase.ack == kAcknowledgedLater) ninth_.push_back(reader.port);
    const bool all_known = ninth_.empty();
    for (const Contender& reader : reads_) {
        I2cPhase phase = done.phase;
        phase.ack = reader.phase.ack;
        if (phase.ack != 0 || (all_known && !line_low_)) {
            answer(reader.port, phase, I2cPhaseKind::Data, done.answer, done.earliest);
        } else if (line_low_) {
            phase.byte = byte_read_;
            lose(reader.port, phase, {false, kReleased, done.answer.stretch}, done.earliest);
            drop_sharer(reader.port);
        } else {
            refusing_.push_back({reader.port, phase});
        }
    }
}

/// The ninth clock of a byte read: all who give it later have stated it. Who went on without it let SDA be.
void I2cBusNode::decide_ninth_clock() {
    const std::vector<Contender> given = std::exchange(given_, {}), refusing = std::exchange(refusing_, {});
    const bool low = line_low_ || std::any_of(given.begin(), given.end(),
                                              [](const Contender& one) { return one.phase.ack != 0; });
    for (const Contender& one : given) {
        if (low && one.phase.ack == 0)
            lose_share(one.port, one.phase, 1);
        else
            answer_sharer(one.port, one.phase, I2cPhaseKind::Acknowledge, low, 1);
    }
    for (const Contender& reader : reads_) {
        const auto turn = std::find_if(turns_.begin(), turns_.end(),
                                       [&](const Contender& other) { return other.port == reader.port; });
        if (!low || reader.phase.ack != kAcknowledgedLater || turn == turns_.end()) continue;
        const Contender loser = *turn;
        lose_share(loser.port, loser.phase, 1);
    }
    for (const Contender& one : refusing) {
        I2cPhase phase = one.phase;
        phase.start = now_;
        phase.byte = byte_read_;
        if (low)
            lose_share(one.port, phase, 1);
        else
            answer_sharer(one.port, phase, I2cPhaseKind::Data, false, 1);
    }
    if (low) return;
    I2cPhase refused;
    refused.kind = I2cPhaseKind::Acknowledge;
    refused.start = now_;
    refused.clock_period = nominal_period_;
    not_acknowledged(refused);
}

}  // namespace puckloop::cosim
