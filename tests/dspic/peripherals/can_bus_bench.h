#pragma once
// Chips on a CAN bus (cosim/can), with or without somebody else there, without a conductor.

#include "cosim/can/can_bus.h"
#include "cosim/can/can_message.h"
#include "tests/dspic/chip30_bench.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace puckloop::dspic::test {

using cosim::CanKind, cosim::CanMessage;
using protocols::CanFrame;

/// Pins whose CAN1 is on a bus, or alone.
struct CanPins : Pins30 {
    explicit CanPins(bool is_wired = true) : wired(is_wired) {}
    const bool wired;
    std::vector<CanMessage> to_bus;
    bool can_wired(int unit) const override { return wired && unit == 1; }
    void can_to_bus(int, const CanMessage& message, Cycle) override { to_bus.push_back(message); }
};

/// A frame that somebody else sent has ended.
inline void receive(Chip& chip, const CanFrame& frame) {
    CanMessage message;
    message.kind = CanKind::Received;
    cosim::put_frame(message, frame);
    chip.can_news(1, message);
}

class CanBusBench {
  public:
    struct Told {
        std::size_t chip = 0;
        cosim::Time time = 0;
        CanMessage message;
    };
    /// The port behind the chips' is a peer's, which the test speaks for.
    explicit CanBusBench(std::vector<std::pair<Chip*, CanPins*>> chips,
                         std::vector<cosim::CarriedFault> faults = {})
        : chips_(std::move(chips)), bus_({"can", names(chips_.size()), "", std::move(faults)}) {}

    /// The peer sends this at `time`, after all before.
    void peer(cosim::Time time, const CanMessage& message) {
        waiting_.push_back({time, static_cast<cosim::PortIndex>(chips_.size()), message});
    }
    void peer_joins(cosim::Time time, cosim::Time bit) {
        CanMessage message;
        message.kind = CanKind::Join;
        message.bit_time = static_cast<std::uint32_t>(bit);
        message.data = {16, 11, 1};
        peer(time, message);
    }
    void peer_sends(cosim::Time time, const CanFrame& frame) {
        CanMessage message;
        message.kind = CanKind::Offer;
        cosim::put_frame(message, frame);
        peer(time, message);
    }
    void run_until(cosim::Time until) {
        while (now_ < until) {
            cosim::Time next = std::min(until, now_ + cosim::CanBusNode::kLookahead);
            for (cosim::PortIndex port = 0; port < chips_.size(); ++port)
                next = std::min(next, bus_.earliest_output(port));
            for (std::size_t i = 0; i < chips_.size(); ++i)
                run_chip(i, next);
            std::stable_sort(waiting_.begin(), waiting_.end(),
                             [](const auto& a, const auto& b) { return a.time < b.time; });
            const auto later = std::find_if(waiting_.begin(), waiting_.end(),
                                            [&](const auto& message) { return message.time >= next; });
            const std::vector<cosim::Message> inbox(waiting_.begin(), later);
            waiting_.erase(waiting_.begin(), later);
            std::vector<cosim::Message> out;
            bus_.advance(next, inbox, out);
            for (const cosim::Message& message : out)
                deliveries_.push_back({message.port, message.time, std::get<CanMessage>(message.payload)});
            now_ = next;
        }
    }
    /// What the bus has reported so far.
    std::vector<Told> told(std::size_t chip, CanKind kind) const {
        std::vector<Told> some;
        for (const Told& one : told_)
            if (one.chip == chip && one.message.kind == kind) some.push_back(one);
        return some;
    }

  private:
    static std::vector<std::string> names(std::size_t chips) {
        std::vector<std::string> names;
        for (std::size_t i = 0; i < chips; ++i)
            names.push_back("chip" + std::to_string(i));
        names.emplace_back("peer");
        return names;
    }
    void run_chip(std::size_t index, cosim::Time until) {
        auto& [chip, pins] = chips_[index];
        for (auto one = deliveries_.begin(); one != deliveries_.end();) {
            if (one->chip != index || one->time >= until) {
                ++one;
                continue;
            }
            chip->run_until(one->time);
            chip->can_news(1, one->message);
            told_.push_back(*one);
            one = deliveries_.erase(one);
        }
        chip->run_until(until);
        for (const CanMessage& message : pins->to_bus)
            waiting_.push_back({message.start, static_cast<cosim::PortIndex>(index), message});
        pins->to_bus.clear();
    }

    std::vector<std::pair<Chip*, CanPins*>> chips_;
    cosim::CanBusNode bus_;
    std::vector<cosim::Message> waiting_;
    std::vector<Told> deliveries_, told_;
    cosim::Time now_ = 0;
};

}  // namespace puckloop::dspic::test
