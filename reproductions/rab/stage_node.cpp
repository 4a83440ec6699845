#include "reproductions/rab/stage_node.h"

#include "physics/description/parameters.h"
#include "physics/world/pose_signals.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::tools {

using cosim::kMillisecond;
using cosim::kNever;
using cosim::Time;

namespace {

constexpr std::uint8_t kAddress = 0x20;
constexpr double kI2cHertz = 400e3;
// Within a turn of 24 ms or more: a frame of 16 bits is on the air for 4.5 ms from about 2 ms after its
// command, and can be read 2.9 ms after its end.
constexpr Time kFirstSend = kMillisecond / 5;
constexpr Time kSecondSend = 12 * kMillisecond;
constexpr Time kPollAfter = 10 * kMillisecond + kMillisecond / 2;
// Registers of the board.
constexpr std::uint8_t kMessage = 0, kData = 1, kBearing = 3, kRange = 5, kLast = 6;
constexpr std::uint8_t kPowerRegister = 12, kHighByte = 13, kSendAll = 14, kSendEach = 15, kCalibrate = 16,
                       kOnBoard = 17;

constexpr int kQueue = 10;                        // messages that wait on a board
constexpr double kWithin = std::numbers::pi / 4;  // of the line, for a single emitter

double wrapped(double angle) {
    return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace

double StagePlan::duration() const {
    const auto turns = static_cast<double>(distances.size()) * repeats + 1;
    return boot + turns * turn + (kQueue + 1) * poll_period;
}

StageNode::StageNode(const StagePlan& plan, std::vector<RabReadingRow>& rows)
    : plan_(plan),
      rows_(rows),
      ports_{{"poses", cosim::PortKind::Signals},
             {"i2c0", cosim::PortKind::I2c},
             {"i2c1", cosim::PortKind::I2c}},
      headings_(plan.seed, "stage/headings"),
      emitters_(plan.seed, "stage/emitters"),
      hosts_{I2cHost(kAddress, kI2cHertz), I2cHost(kAddress, kI2cHertz)} {
    const Time ready = cosim::from_seconds(plan.boot);
    for (I2cHost& host : hosts_) {
        host.write(ready - 8 * kMillisecond, {kPowerRegister, static_cast<std::uint8_t>(plan.power)});
        host.write(ready - 6 * kMillisecond, {kOnBoard, 0});
        host.write(ready - 4 * kMillisecond, {kCalibrate, 0});
    }
    next_pose_ = plan.distances.empty() || plan.repeats < 1 ? kNever : ready;
    for (const int receiver : {0, 1})
        if (plan.poll_period > 0)
            schedule(ready + cosim::from_seconds(plan.poll_period * (receiver + 1) / 3),
                     [this, receiver](Time at) { poll_again(receiver, at); });
}

void StageNode::schedule(Time at, std::function<void(Time)> action) {
    actions_.emplace(at, std::move(action));
}

void StageNode::pose(Time now, std::vector<cosim::Message>& outbox) {
    const double apart = 2 * plan_.body_radius + plan_.distances[distance_];
    for (std::size_t i = 0; i < 2; ++i) {
        heading_[i] = 2 * std::numbers::pi * headings_.uniform();
        const double pose[] = {i == 0 ? 0.0 : apart, 0.0, heading_[i]};
        for (std::size_t k = 0; k < physics::kPoseSignals; ++k)
            outbox.push_back(
                {now, 0, cosim::Signal{static_cast<std::uint16_t>(i * physics::kPoseSignals + k), pose[k]}});
    }
    for (int sender = 0; sender < 2; ++sender) {
        const Time start = now + kFirstSend + sender * kSecondSend;
        schedule(start, [this, sender](Time at) { send(sender, at); });
        if (plan_.poll_period > 0) continue;
        schedule(start + kPollAfter, [this, sender](Time at) { poll(1 - sender, at); });
    }
    if (++repeat_ == plan_.repeats) {
        repeat_ = 0;
        ++distance_;
    }
    next_pose_ = distance_ == plan_.distances.size() ? kNever : now + cosim::from_seconds(plan_.turn);
}

/// One of those within 45 degrees of the receiver, by the drawing.
int StageNode::facing_emitter(double bearing) {
    const physics::Parameters drawing;
    std::vector<int> near;
    for (int e = 0; e < physics::kIrSensors; ++e)
        if (std::abs(wrapped(bearing - drawing.ir.emitter_angle[static_cast<std::size_t>(e)])) < kWithin)
            near.push_back(e + 1);
    return near[emitters_.below(near.size())];
}

void StageNode::poll_again(int receiver, Time now) {
    poll(receiver, now);
    schedule(now + cosim::from_seconds(plan_.poll_period),
             [this, receiver](Time at) { poll_again(receiver, at); });
}

void StageNode::send(int sender, Time now) {
    ++payload_;
    RabReadingRow row;
    row.distance = repeat_ == 0 ? distance_ - 1 : distance_;  // already counted on
    row.sender = sender;
    const double direction = sender == 0 ? std::numbers::pi : 0.0;  // seen from the receiver
    row.bearing_true = wrapped(direction - heading_[static_cast<std::size_t>(1 - sender)]);
    row.bearing_back = wrapped(direction - std::numbers::pi - heading_[static_cast<std::size_t>(sender)]);
    row.emitter = plan_.one_emitter ? facing_emitter(row.bearing_back) : 0;
    rows_.push_back(row);
    I2cHost& host = hosts_[static_cast<std::size_t>(sender)];
    now += host.clock();  // a reaction, as every answer has
    host.write(now, {kHighByte, static_cast<std::uint8_t>(payload_ >> 8)});
    const auto low = static_cast<std::uint8_t>(payload_ & 0xFF);
    if (row.emitter == 0) {
        host.write(now, {kSendAll, low});
    } else {
        host.write(now, {static_cast<std::uint8_t>(row.emitter - 1), low});
        host.write(now, {kSendEach, 0});
    }
}

void StageNode::poll(int receiver, Time now) {
    I2cHost& host = hosts_[static_cast<std::size_t>(receiver)];
    host.read(now + host.clock(), kMessage, [this, receiver](std::optional<std::uint8_t> byte, Time at) {
        if (byte == 1) fetch(receiver, at);
    });
}

void StageNode::fetch(int receiver, Time now) {
    for (std::uint8_t number = kData; number <= kLast; ++number)
        hosts_[static_cast<std::size_t>(receiver)].read(
            now, number, [this, receiver, number](std::optional<std::uint8_t> byte, Time at) {
                registers_[number] = byte.value_or(0);
                if (number == kLast) message(receiver, at);
            });
}

/// All registers of a message are here. Payloads count the frames, so each finds its row.
void StageNode::message(int receiver, Time now) {
    const auto word = [this](std::size_t high) {
        return static_cast<std::uint16_t>(registers_[high] << 8 | registers_[high + 1]);
    };
    const std::size_t index = word(kData) - std::size_t{1};
    if (index < rows_.size() && rows_[index].sender != receiver && !rows_[index].received) {
        RabReadingRow& row = rows_[index];
        row.received = true;
        row.late = index + 1 != rows_.size();
        row.bearing = 1e-4 * static_cast<std::int16_t>(word(kBearing));
        row.range = word(kRange);
    } else if (!rows_.empty()) {
        ++rows_.back().strays;
    }
    if (plan_.poll_period == 0) poll(receiver, now);  // until there is no other
}

void StageNode::advance(Time until, std::span<const cosim::Message> inbox,
                        std::vector<cosim::Message>& outbox) {
    auto message = inbox.begin();
    for (;;) {
        const Time arrives = message == inbox.end() ? kNever : message->time;
        const Time acts = actions_.empty() ? kNever : actions_.begin()->first;
        const Time due = std::min(hosts_[0].due(), hosts_[1].due());
        const Time now = std::min({arrives, acts, due, next_pose_});
        if (now >= until) return;
        if (now == arrives) {
            if (const auto* answer = std::get_if<cosim::I2cPhase>(&message->payload);
                answer && message->port > 0)
                hosts_[message->port - 1U].answered(*answer, now);
            ++message;
        } else if (now == next_pose_) {
            pose(now, outbox);
        } else if (now == acts) {
            const auto action = std::move(actions_.begin()->second);
            actions_.erase(actions_.begin());
            action(now);
        } else {
            const std::size_t host = hosts_[0].due() == now ? 0 : 1;
            outbox.push_back({now, static_cast<cosim::PortIndex>(host + 1), hosts_[host].next()});
        }
    }
}

Time StageNode::earliest_output(cosim::PortIndex port) const {
    if (port == 0) return next_pose_;
    const I2cHost& host = hosts_[port - 1U];
    const Time acts = actions_.empty() ? kNever : actions_.begin()->first + host.clock();
    return std::min({host.due(), acts, cosim::later(next_pose_, kFirstSend)});
}

Time StageNode::lookahead(cosim::PortIndex port) const {
    return port == 0 ? kNever : hosts_[port - 1U].clock();
}

}  // namespace puckloop::tools
