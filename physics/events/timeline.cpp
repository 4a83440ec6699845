#include "physics/events/timeline.h"

#include "base/json.h"
#include "protocols/infrared/rc5.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::physics {

namespace {

using cosim::Time;

constexpr Time kTimelineStep = cosim::kMillisecond;
constexpr Time kFirstSignal = cosim::kMicrosecond;  // boards begin to run before the world is asked
constexpr Time kButtonDown = cosim::kMillisecond;

bool acts_on_board(const Action& action) {
    return action.verb == Verb::Select || action.verb == Verb::Reset || action.verb == Verb::Remote ||
           action.verb == Verb::Send;
}

}  // namespace

Timeline::Timeline(WorldModel& model, EventPlan plan, CommandSource* commands)
    : plan_(std::move(plan)),
      scene_(model),
      watches_(plan_, scene_),
      journal_(plan_),
      model_(model),
      commands_(commands),
      begun_(plan_.events.size()) {
    for (std::size_t i = 0; i < plan_.events.size(); ++i)
        if (plan_.events[i].at) schedule(i, *plan_.events[i].at, ++serial_);
}

Time Timeline::now() const {
    return static_cast<Time>(model_.steps_done()) * kTimelineStep;
}

const Action& Timeline::action_of(const Due& due) const {
    return due.event == Journal::kLive ? *live_.at(due.serial).action : plan_.events[due.event].action;
}

void Timeline::schedule(std::size_t event, Time time, std::uint64_t serial) {
    const Due due{time, event, serial};
    if (event != Journal::kLive) ++begun_[event];
    if (acts_on_board(action_of(due)))
        boards_.insert({std::max(time, kFirstSignal), event, serial});
    else
        bodies_.insert(due);
}

void Timeline::repeat(const Due& due) {
    const Event& event = plan_.events[due.event];
    if (event.every == 0 || (event.count != 0 && begun_[due.event] >= event.count)) return;
    const auto times = static_cast<Time>(begun_[due.event]);
    schedule(due.event, *event.at + times * event.every, ++serial_);
}

/// What was to happen after this event.
void Timeline::follow(std::size_t event, Time time, Time earliest) {
    const std::string& name = plan_.events[event].name;
    for (std::size_t i = 0; i < plan_.events.size(); ++i) {
        const Event& next = plan_.events[i];
        if (!next.when || next.when->kind != Condition::Kind::After || next.when->other != name) continue;
        if (begun_[i] < next.count) schedule(i, std::max(time + next.delay, earliest), ++serial_);
    }
}

void Timeline::at_step(std::vector<std::string>& log) {
    if (!active()) return;
    watches_.bodies_moved();
    scene_.glide();
    while (!bodies_.empty() && bodies_.begin()->time <= now()) {
        const Due due = *bodies_.begin();
        bodies_.erase(bodies_.begin());
        const std::string refused = scene_.apply(action_of(due));
        finish(due, now() + kTimelineStep, refused, log);
    }
    for (const std::size_t event : watches_.come_true())
        schedule(event, now() + kTimelineStep + plan_.events[event].delay, ++serial_);
    hear();
    carry_out(log);
}

/// What boards get until the next step.
void Timeline::carry_out(std::vector<std::string>& log) {
    while (!boards_.empty() && boards_.begin()->time <= now() + kTimelineStep) {
        const Due due = *boards_.begin();
        boards_.erase(boards_.begin());
        const std::string refused = send(action_of(due), due.time);
        finish(due, now() + 2 * kTimelineStep, refused, log);
    }
}

void Timeline::finish(const Due& due, Time earliest, const std::string& refused,
                      std::vector<std::string>& log) {
    const Action& action = action_of(due);
    if (refused.empty())
        journal_.done(due.event, due.time, action);
    else if (due.event != Journal::kLive)
        journal_.refused(due.event, due.time, action, refused);
    log.push_back(refused.empty() ? action.command
                                  : fmt::format("not done: {}: {}", action.command, refused));
    if (due.event == Journal::kLive) {
        nlohmann::ordered_json reply;
        reply[refused.empty() ? "done" : "refused"] = refused.empty() ? action.command : refused;
        reply["at_s"] = in_seconds(due.time);
        commands_->reply(live_.at(due.serial).id, reply.dump());
        live_.erase(due.serial);
        return;
    }
    if (plan_.events[due.event].at) repeat(due);
    if (refused.empty()) follow(due.event, due.time, earliest);
}

void Timeline::hear() {
    if (commands_ == nullptr) return;
    for (Command& command : commands_->poll()) {
        if (!command.action) {
            commands_->reply(command.id, list());
            continue;
        }
        live_[++serial_] = std::move(command);
        schedule(Journal::kLive, now() + kTimelineStep, serial_);
    }
}

std::string Timeline::list() const {
    nlohmann::ordered_json all = nlohmann::ordered_json::array();
    for (const auto& one : scene_.list())
        all.push_back({{"kind", one.kind},
                       {"name", one.name},
                       {"x_m", one.pose.x},
                       {"y_m", one.pose.y},
                       {"theta_rad", one.pose.heading},
                       {"lifted", one.lifted}});
    return nlohmann::ordered_json{{"list", all}, {"at_s", model_.seconds()}}.dump();
}

std::string Timeline::send(const Action& action, Time time) {
    if (std::string problem = problem_of(action); !problem.empty()) return problem;
    if (action.verb == Verb::Remote) return press_key(action, time);
    if (action.verb == Verb::Send) return send_datagram(action, time);
    const Found robot = scene_.find(action.object);
    if (!robot) return scene_.unknown(action.object);
    if (robot.kind != Found::Kind::Robot) return fmt::format("'{}' is no robot", action.object);
    const auto add = [&](Time when, BoardInput input, double value) {
        signals_.insert({when, {when, robot.index, input, value}});
    };
    if (action.verb == Verb::Select) {
        add(time, BoardInput::Selector, action.number);
    } else {
        add(time, BoardInput::Reset, 1.0);
        add(time + kButtonDown, BoardInput::Reset, 0.0);
    }
    return {};
}

std::string Timeline::send_datagram(const Action& action, Time time) {
    if (std::string problem = problem_of_computer(plan_, action.object); !problem.empty()) return problem;
    for (const Computer& one : plan_.computers)
        if (one.name == action.object)
            datagrams_.push_back({time, one.address, static_cast<std::uint16_t>(action.number), action.text});
    return {};
}

std::string Timeline::press_key(const Action& action, Time time) {
    const Found robot = scene_.find(action.object);
    const bool all = action.object == kEveryRobot && !robot;
    if (!all && !robot) return scene_.unknown(action.object);
    if (!all && robot.kind != Found::Kind::Robot) return fmt::format("'{}' is no robot", action.object);
    if (time < key_released_)
        return fmt::format("the key before is held until {}", seconds_text(key_released_));
    constexpr Time kRepeat = protocols::kRc5RepeatMicroseconds * cosim::kMicrosecond;
    const auto frames = 1 + cosim::from_seconds(action.hold) / kRepeat;
    toggle_ = !toggle_;
    const auto edges = protocols::rc5_frame(toggle_, action.address, action.number);
    for (std::size_t i = 0; i < model_.robot_count(); ++i) {
        if (!all && i != robot.index) continue;
        for (Time frame = 0; frame < frames; ++frame)
            for (const auto& edge : edges) {
                const Time when = time + frame * kRepeat + edge.microseconds * cosim::kMicrosecond;
                signals_.insert({when, {when, i, BoardInput::Remote, edge.high ? 1.0 : 0.0}});
            }
    }
    key_released_ = time + frames * kRepeat;
    return {};
}

void Timeline::take_signals(std::vector<BoardSignal>& signals) {
    while (!signals_.empty() && signals_.begin()->first <= now() + kTimelineStep) {
        signals.push_back(signals_.begin()->second);
        signals_.erase(signals_.begin());
    }
}

Time Timeline::next_signal() const {
    Time next = boards_.empty() ? cosim::kNever : boards_.begin()->time;
    if (!signals_.empty()) next = std::min(next, signals_.begin()->first);
    return next;
}

void Timeline::end() {
    if (commands_ == nullptr) return;
    for (const auto& [serial, command] : live_)
        commands_->reply(command.id, R"({"refused":"the run ended before"})");
    live_.clear();
}

}  // namespace puckloop::physics
