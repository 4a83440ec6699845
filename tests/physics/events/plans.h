#pragma once
// Plans, and nodes that carry them out, for the tests of physics/events.

#include "base/json.h"
#include "physics/node/world_node.h"
#include "tests/physics/worlds.h"

#include <algorithm>

namespace puckloop::physics::test {

using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Signal;
using cosim::Time;

// Ids on the board's link: channels first, as channels.h numbers them.
inline constexpr std::uint16_t kLeftId = 42, kRightId = 43, kLedId = 44;
inline constexpr std::uint16_t kSelectorId = 50, kResetId = 51, kRemoteId = 52;

inline void link_up(World& world) {
    for (auto& robot : world.robots) {
        for (std::size_t i = 0; i < kGroundChannel; ++i)
            robot.board_signals[std::string(channel_name(i))] = static_cast<std::uint16_t>(i);
        robot.board_signals["wheel_left"] = kLeftId;
        robot.board_signals["wheel_right"] = kRightId;
        robot.board_signals["led0"] = kLedId;
        robot.board_signals["selector"] = kSelectorId;
        robot.board_signals["reset"] = kResetId;
        robot.board_signals["remote"] = kRemoteId;
        for (std::size_t i = 0; i < 6; ++i)
            robot.ground_signals[std::string(channel_name(kGroundChannel + i))] =
                static_cast<std::uint16_t>(i);
    }
}

inline Action action(Verb verb, const std::string& object) {
    Action result;
    result.verb = verb;
    result.object = object;
    result.command = "action on " + object;
    return result;
}

inline Action move_to(const std::string& object, double x, double y, double over = 0.0) {
    Action result = action(Verb::Move, object);
    result.to = Point{x, y};
    result.over = over;
    return result;
}

inline Event at(Time time, Action what) {
    Event event;
    event.name = "event at " + std::to_string(time);
    event.place = "line 1";
    event.at = time;
    event.action = std::move(what);
    return event;
}

inline Event when(Condition condition, Action what, std::string name = "conditional") {
    Event event;
    event.name = std::move(name);
    event.place = "line 2";
    event.when = std::move(condition);
    event.action = std::move(what);
    return event;
}

/// Even steps of both motors of robot 0, `rate` a second.
inline std::vector<Message> even_steps(double left, double right, Time duration) {
    std::vector<Message> messages;
    const auto side = [&](double rate, std::uint16_t id) {
        if (rate == 0.0) return;
        const Time period = cosim::from_seconds(1.0 / std::abs(rate));
        double count = 0;
        for (Time t = period; t < duration; t += period)
            messages.push_back({t, 0, Signal{id, count += rate > 0 ? 1.0 : -1.0}});
    };
    side(left, kLeftId);
    side(right, kRightId);
    std::stable_sort(messages.begin(), messages.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return messages;
}

/// Runs a node with grants of `slice`, holding it to its EOTs; what it sent.
inline std::vector<Message> run_node(cosim::Node& node, const std::vector<Message>& inputs, Time duration,
                                     Time slice) {
    std::vector<Message> all;
    auto next = inputs.begin();
    for (Time until = slice;; until += slice) {
        until = std::min(until, duration);
        auto end = next;
        while (end != inputs.end() && end->time < until)
            ++end;
        const Time earliest = node.earliest_output(0);
        const Time lookahead = next == end ? cosim::kNever : next->time + node.lookahead(0);
        std::vector<Message> out;
        node.advance(until, std::vector<Message>(next, end), out);
        for (const auto& message : out)
            if (message.time < std::min(earliest, lookahead))
                throw std::logic_error("sent before its earliest output time");
        for (cosim::PortIndex port = 0; port < node.ports().size(); ++port) {
            Time last = 0;
            for (const auto& message : out) {
                if (message.port != port) continue;
                if (message.time < last) throw std::logic_error("out of order");
                last = message.time;
            }
        }
        all.insert(all.end(), out.begin(), out.end());
        next = end;
        if (until == duration) return all;
    }
}

/// Changes of one signal: time and value.
inline std::vector<std::pair<Time, double>> changes(const std::vector<Message>& messages,
                                                    cosim::PortIndex port, std::uint16_t id) {
    std::vector<std::pair<Time, double>> found;
    for (const auto& message : messages)
        if (const auto& signal = std::get<Signal>(message.payload); message.port == port && signal.id == id)
            found.emplace_back(message.time, signal.value);
    return found;
}

inline std::unique_ptr<WorldNode> node_with(const World& world, std::vector<Event> events) {
    EventPlan plan;
    plan.events = std::move(events);
    return std::make_unique<WorldNode>(world, plan, nullptr);
}

}  // namespace puckloop::physics::test
