#include "physics/world_node.h"

#include "physics/pose_signals.h"
#include "physics/recorder.h"
#include "physics/world_log.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>

namespace puckloop::physics {

namespace {

constexpr cosim::Time kStep = cosim::kMillisecond;
constexpr std::uint16_t kUnused = 0xFFFF;
constexpr std::size_t kPortsOfRobot = 2;
constexpr std::array<double, kPoseSignals> kPoseQuantum{1e-5, 1e-5, 1e-4};  // m, m, rad

/// One robot's ends of its two links: signal ids, and what was last published.
struct RobotLinks {
    std::array<std::uint16_t, 2> wheel{kUnused, kUnused};
    struct Output {
        std::size_t channel = 0;
        cosim::PortIndex port = 0;
        std::uint16_t id = 0;
        double last = std::nan("");
    };
    std::vector<Output> outputs;
};

RobotLinks links_of(const Robot& robot, cosim::PortIndex board) {
    RobotLinks links;
    const auto id_of = [](const std::map<std::string, std::uint16_t>& ids, std::string_view name) {
        const auto found = ids.find(std::string(name));
        return found == ids.end() ? kUnused : found->second;
    };
    links.wheel = {id_of(robot.board_signals, "wheel_left"), id_of(robot.board_signals, "wheel_right")};
    const bool has_voltage = robot.board_signals.contains("battery_v");
    for (std::size_t channel = 0; channel < kChannelCount; ++channel) {
        if (channel == kBatteryLowChannel && has_voltage) continue;  // the board derives it
        const auto name = channel_name(channel);
        if (const auto id = id_of(robot.board_signals, name); id != kUnused)
            links.outputs.push_back({channel, board, id, silent_at_zero(channel) ? 0.0 : std::nan("")});
        if (const auto id = id_of(robot.ground_signals, name); id != kUnused)
            links.outputs.push_back({channel, static_cast<cosim::PortIndex>(board + 1), id});
    }
    return links;
}

}  // namespace

struct WorldNode::Impl {
    explicit Impl(World description);
    void take(const cosim::Message& message);
    void publish(std::vector<cosim::Message>& outbox);
    void publish_poses(std::vector<cosim::Message>& outbox);

    WorldModel model;
    std::vector<cosim::Port> ports;
    std::vector<RobotLinks> links;
    std::vector<double> poses;            // as last published; empty without the port "ir"
    std::vector<cosim::Message> waiting;  // stamped at or after the next step
    std::optional<Recorder> recorder;
    WorldLog log;
    cosim::Time next_step = 0;  // its sensor values leave one step later
};

WorldNode::Impl::Impl(World description) : model(std::move(description)), log(model) {
    for (const auto& robot : model.description().robots) {
        links.push_back(links_of(robot, static_cast<cosim::PortIndex>(ports.size())));
        ports.push_back({robot.name + ".board", cosim::PortKind::Signals});
        ports.push_back({robot.name + ".ground", cosim::PortKind::Signals});
    }
    if (has_rab(model.description())) {
        ports.push_back({"ir", cosim::PortKind::Signals});
        poses.assign(pose_signal_names(model.description()).size(), std::nan(""));
    }
    if (!model.description().recording.directory.empty()) recorder.emplace(model);
}

void WorldNode::Impl::take(const cosim::Message& message) {
    const auto* signal = std::get_if<cosim::Signal>(&message.payload);
    const std::size_t robot = message.port / kPortsOfRobot;
    if (signal == nullptr || message.port % kPortsOfRobot != 0 || robot >= links.size()) return;
    for (const Side side : {Side::Left, Side::Right})
        if (links[robot].wheel[static_cast<std::size_t>(side)] == signal->id)
            model.wheel(robot, side, signal->value, cosim::to_seconds(message.time));
}

void WorldNode::Impl::publish(std::vector<cosim::Message>& outbox) {
    const double count_quantum = model.parameters().world.publish_quantum;
    for (std::size_t robot = 0; robot < links.size(); ++robot) {
        const auto& channels = model.robot(robot).channels();
        for (auto& output : links[robot].outputs) {
            const double quantum = channel_quantum(output.channel, count_quantum);
            const double value = std::round(channels[output.channel] / quantum) * quantum;
            if (value == output.last) continue;
            output.last = value;
            outbox.push_back({next_step + kStep, output.port, cosim::Signal{output.id, value}});
        }
    }
}

void WorldNode::Impl::publish_poses(std::vector<cosim::Message>& outbox) {
    const auto port = static_cast<cosim::PortIndex>(links.size() * kPortsOfRobot);
    for (std::size_t i = 0; i * kPoseSignals < poses.size(); ++i) {
        const auto pose = [&](const auto& s) {
            return std::array<double, kPoseSignals>{s.x, s.y, s.heading};
        };
        const auto now = i < links.size() ? pose(model.state(i)) : pose(model.object(i - links.size()));
        for (std::size_t k = 0; k < kPoseSignals; ++k) {
            const std::size_t id = i * kPoseSignals + k;
            const double value = std::round(now[k] / kPoseQuantum[k]) * kPoseQuantum[k];
            if (value == poses[id]) continue;
            poses[id] = value;
            outbox.push_back({next_step + kStep, port, cosim::Signal{static_cast<std::uint16_t>(id), value}});
        }
    }
}

WorldNode::WorldNode(World description) : impl_(std::make_unique<Impl>(std::move(description))) {}

WorldNode::~WorldNode() = default;

std::string_view WorldNode::name() const {
    return impl_->model.description().node_name;
}

std::span<const cosim::Port> WorldNode::ports() const {
    return impl_->ports;
}

void WorldNode::advance(cosim::Time until, std::span<const cosim::Message> inbox,
                        std::vector<cosim::Message>& outbox) {
    auto& w = *impl_;
    w.waiting.insert(w.waiting.end(), inbox.begin(), inbox.end());
    auto next = w.waiting.begin();
    // Everything stamped before `until` is here, so a step at `until` itself can be taken as well.
    for (; w.next_step <= until; w.next_step += kStep) {
        if (w.next_step > 0) {
            for (; next != w.waiting.end() && next->time < w.next_step; ++next)
                w.take(*next);
            w.model.step();
            if (w.recorder) w.recorder->after_step(w.model);
            w.log.after_step(w.model);
        }
        w.publish(outbox);
        w.publish_poses(outbox);
    }
    w.waiting.erase(w.waiting.begin(), next);
}

cosim::Time WorldNode::promise(cosim::PortIndex) const {
    return impl_->next_step + kStep;
}

cosim::Time WorldNode::reaction(cosim::PortIndex) const {
    return kStep + 1;  // a message just before a step shows one step after it
}

std::string WorldNode::finish() {
    const auto& model = impl_->model;
    impl_->log.end(model);
    nlohmann::ordered_json report;
    report["steps"] = model.steps_done();
    report["robots"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < model.robot_count(); ++i) {
        const auto& s = model.state(i);
        const auto& robot = model.robot(i);
        report["robots"].push_back({{"robot", model.description().robots[i].name},
                                    {"x_m", s.x},
                                    {"y_m", s.y},
                                    {"theta_rad", s.heading},
                                    {"steps_left", std::llround(robot.drive(Side::Left).steps())},
                                    {"steps_right", std::llround(robot.drive(Side::Right).steps())},
                                    {"steps_lost_left", std::llround(robot.drive(Side::Left).lost())},
                                    {"steps_lost_right", std::llround(robot.drive(Side::Right).lost())},
                                    {"battery_v", robot.channels()[kBatteryVoltageChannel]}});
        if (const auto& floor = robot.floor_motion(); floor.pushes() > 0) {
            auto& told = report["robots"].back();
            told["pushes"] = floor.pushes();
            told["pushed_x_m"] = floor.pushed()[0];
            told["pushed_y_m"] = floor.pushed()[1];
            told["pushed_theta_rad"] = floor.pushed()[2];
        }
    }
    report["ode_messages"] = model.dynamics().complaints();
    if (model.dynamics().complaints() > 0) report["ode_first_message"] = model.dynamics().first_complaint();
    return report.dump();
}

std::unique_ptr<cosim::Node> make_world_node(std::string_view json) {
    return std::make_unique<WorldNode>(from_json(json));
}

}  // namespace puckloop::physics
