#include "physics/node/world_node.h"

#include "base/json.h"
#include "physics/camera/camera_port.h"
#include "physics/events/timeline.h"
#include "physics/node/booth_link.h"
#include "physics/node/robot_links.h"
#include "physics/node/sound_link.h"
#include "physics/world/booth_record.h"
#include "physics/world/pose_signals.h"
#include "physics/world/recorder.h"
#include "physics/world/world_log.h"
#include "protocols/network/ip_packet.h"

#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace puckloop::physics {

namespace {

constexpr cosim::Time kStep = cosim::kMillisecond;
constexpr std::size_t kPortsOfRobot = 2;
constexpr std::array<double, kPoseSignals> kBodyQuantum{1e-5, 1e-5, 1e-4};  // m, m, rad

/// What was done, and what never happened.
void add_events(const Journal& journal, nlohmann::ordered_json& report) {
    report["events"] = nlohmann::ordered_json::array();
    for (const auto& entry : journal.entries()) {
        nlohmann::ordered_json line{{"event", entry.event},
                                    {"at_s", in_seconds(entry.time)},
                                    {"action", entry.command},
                                    {"done", entry.refused.empty()}};
        if (!entry.refused.empty()) line["why"] = entry.refused;
        report["events"].push_back(std::move(line));
    }
    if (const auto warnings = journal.warnings(); !warnings.empty()) report["warnings"] = warnings;
}

/// As from a program of the same computer that has no port.
cosim::Octets octets_of(const Datagram& datagram) {
    protocols::IpPacket packet;
    packet.from = packet.to = datagram.address;
    packet.protocol = protocols::kUdp;
    packet.payload = protocols::encode_udp({0, datagram.port, datagram.text}, packet.from, packet.to);
    return cosim::Octets(protocols::encode(packet));
}

/// The tracker, if there is one, takes the place of `commands`.
Overhead* watch(std::unique_ptr<CommandSource>& commands, std::optional<TrackerPlan> tracker,
                const WorldModel& model) {
    if (!tracker) return nullptr;
    auto overhead = std::make_unique<Overhead>(*std::move(tracker), std::move(commands), model);
    Overhead* watching = overhead.get();
    commands = std::move(overhead);
    return watching;
}

}  // namespace

struct WorldNode::Impl {
    Impl(World description, EventPlan plan, std::unique_ptr<CommandSource> commands, PosePorts media,
         std::optional<TrackerPlan> tracker);
    void add_cameras();
    void take(const cosim::Message& message);
    void step();
    void publish_events(std::vector<cosim::Message>& outbox);
    void publish(std::vector<cosim::Message>& outbox);
    void publish_poses(std::vector<cosim::Message>& outbox);
    void publish_scene(std::vector<cosim::Message>& outbox);
    void publish_virtual_boards(std::vector<cosim::Message>& outbox);
    void publish_body(std::size_t id, double value, std::vector<cosim::Message>& outbox);

    WorldModel model;
    std::vector<cosim::Port> ports;
    std::vector<RobotLinks> links;
    std::vector<BoothLink> booths;
    SoundLink sound;
    cosim::PortIndex first_booth = 0xFFFF;
    cosim::PortIndex messages = 0xFFFF;
    std::vector<cosim::PortIndex> pose_ports;                     // media: they hear where everything is
    std::vector<double> poses;                                    // as last published
    std::map<std::size_t, double> scene;                          // likewise, by id: what events change
    std::vector<std::array<double, kPoseSignals>> virtual_poses;  // of boards, as last published
    std::vector<cosim::Message> waiting;                          // stamped at or after the next step
    std::optional<CameraPort> cameras;
    cosim::PortIndex first_camera = 0xFFFF;
    std::optional<Recorder> recorder;
    std::optional<BoothRecord> booth_record;
    WorldLog log;
    std::unique_ptr<CommandSource> commands;
    Overhead* overhead = nullptr;  // it is `commands`
    Timeline timeline;
    std::vector<std::string> happened;       // scratch
    std::vector<BoardSignal> board_signals;  // scratch
    cosim::Time next_step = 0;               // its sensor values leave one step later
};

WorldNode::Impl::Impl(World description, EventPlan plan, std::unique_ptr<CommandSource> source,
                      PosePorts media, std::optional<TrackerPlan> tracker)
    : model(std::move(description)),
      sound(model.description(), kPortsOfRobot),
      log(model),
      commands(std::move(source)),
      overhead(watch(commands, std::move(tracker), model)),
      timeline(model, std::move(plan), commands.get()) {
    check_events(timeline.plan(), model.description());
    for (const auto& robot : model.description().robots) {
        links.push_back(links_of(robot, static_cast<cosim::PortIndex>(ports.size())));
        ports.push_back({robot.name + ".board", cosim::PortKind::Signals});
        ports.push_back({robot.name + ".ground", cosim::PortKind::Signals});
    }
    if (has_rab(model.description())) {
        pose_ports.push_back(static_cast<cosim::PortIndex>(ports.size()));
        ports.push_back({"ir", cosim::PortKind::Signals});
    }
    if (model.description().ircom) {
        pose_ports.push_back(static_cast<cosim::PortIndex>(ports.size()));
        ports.push_back({"ircom", cosim::PortKind::Signals});
    }
    for (const auto& [there, name] :
         {std::pair(media.bluetooth, "bluetooth"), std::pair(media.network, "network")}) {
        if (!there) continue;
        pose_ports.push_back(static_cast<cosim::PortIndex>(ports.size()));
        ports.push_back({name, cosim::PortKind::Signals});
    }
    if (!pose_ports.empty()) {
        poses.assign(pose_signal_names(model.description()).size(), std::nan(""));
        // The medium knows what is there from the start.
        const SceneSignals ids{poses.size() / kPoseSignals};
        for (std::size_t i = 0; i < model.fixed_count(); ++i)
            for (std::size_t k = 0; k < kShapeSignals; ++k)
                scene[ids.shape(true, i) + k] = values_of(model.fixed(i))[k];
        for (const VirtualBoard& board : model.description().virtuals.boards)
            virtual_poses.push_back({board.x, board.y, board.heading});
    }
    for (std::size_t i = 0; i < links.size(); ++i) {
        const Robot& robot = model.description().robots[i];
        if (!hears_battery(robot)) continue;
        add_battery(links[i], robot, static_cast<cosim::PortIndex>(ports.size()));
        ports.push_back({robot.name + ".rab", cosim::PortKind::Signals});
    }
    for (const auto& booth : model.description().booths) {
        if (booths.empty()) first_booth = static_cast<cosim::PortIndex>(ports.size());
        booths.emplace_back(booth, static_cast<cosim::PortIndex>(ports.size()));
        ports.push_back({booth.name, cosim::PortKind::Signals});
    }
    if (!timeline.plan().computers.empty()) {
        messages = static_cast<cosim::PortIndex>(ports.size());
        ports.push_back({"messages", cosim::PortKind::Network});
    }
    add_cameras();
    const std::string& directory = model.description().recording.directory;
    if (directory.empty()) return;
    recorder.emplace(model);
    if (!booths.empty()) booth_record.emplace(directory + "/tams.csv", model);
}

void WorldNode::Impl::add_cameras() {
    if (!has_camera(model.description())) return;
    first_camera = static_cast<cosim::PortIndex>(ports.size());
    std::vector<cosim::PortIndex> of_cameras;
    for (const auto& robot : model.description().robots) {
        if (!robot.camera) continue;
        of_cameras.push_back(static_cast<cosim::PortIndex>(ports.size()));
        ports.push_back({robot.name + ".camera", cosim::PortKind::Signals});
    }
    cameras.emplace(model, std::move(of_cameras));
}

void WorldNode::Impl::take(const cosim::Message& message) {
    const auto* signal = std::get_if<cosim::Signal>(&message.payload);
    if (signal != nullptr && message.port >= first_booth) {
        const std::size_t index = message.port - first_booth;
        if (index < booths.size()) booths[index].take(*signal, model.booth(index));
        return;
    }
    const std::size_t robot = message.port / kPortsOfRobot;
    if (signal == nullptr || robot >= links.size()) return;
    const bool from_board = message.port % kPortsOfRobot == 0;
    if (cameras) cameras->led(robot, !from_board, signal->id, signal->value);
    if (!from_board) return;
    for (const Side side : {Side::Left, Side::Right})
        if (links[robot].wheel[static_cast<std::size_t>(side)] == signal->id)
            model.wheel(robot, side, signal->value, cosim::to_seconds(message.time));
    sound.take(robot, signal->id, signal->value, cosim::to_seconds(message.time));
    model.board_signal(robot, signal->id, signal->value);
    if (timeline.active()) timeline.board_signal(robot, signal->id, signal->value);
}

/// To the state at next_step, and what happens to it there.
void WorldNode::Impl::step() {
    if (next_step > 0) model.move_bodies();
    if (overhead != nullptr) overhead->at_step(model, timeline.journal());
    if (timeline.active()) {
        happened.clear();
        timeline.at_step(happened);
        for (const std::string& text : happened)
            log.note(model.seconds(), text);
    }
    if (next_step > 0 || !happened.empty()) model.sense();
    if (next_step == 0) return;
    if (recorder) recorder->after_step(model);
    if (booth_record) booth_record->after_step(model);
    log.after_step(model);
    model.done(StepPart::Record);
}

void WorldNode::Impl::publish_events(std::vector<cosim::Message>& outbox) {
    if (!timeline.active()) return;
    board_signals.clear();
    timeline.take_signals(board_signals);
    for (const BoardSignal& signal : board_signals) {
        const auto id = links[signal.robot].input[static_cast<std::size_t>(signal.input)];
        const auto port = static_cast<cosim::PortIndex>(signal.robot * kPortsOfRobot);
        if (id != kUnusedSignal) outbox.push_back({signal.time, port, cosim::Signal{id, signal.value}});
    }
    for (const Datagram& one : timeline.take_datagrams())
        outbox.push_back({one.time, messages, cosim::Packet{one.time, 0, octets_of(one)}});
}

void WorldNode::Impl::publish(std::vector<cosim::Message>& outbox) {
    const double count_quantum = model.parameters().world.publish_quantum;
    for (std::size_t robot = 0; robot < links.size(); ++robot)
        links[robot].publish(model.robot(robot).channels(), count_quantum, next_step + kStep, outbox);
    for (std::size_t i = 0; i < booths.size(); ++i)
        booths[i].publish(model.booth(i), next_step + kStep, outbox);
}

void WorldNode::Impl::publish_poses(std::vector<cosim::Message>& outbox) {
    for (std::size_t i = 0; i * kPoseSignals < poses.size(); ++i) {
        const auto pose = [&](const auto& s) {
            return std::array<double, kPoseSignals>{s.x, s.y, s.heading};
        };
        const auto now = i < links.size() ? pose(model.state(i)) : pose(model.object(i - links.size()));
        for (std::size_t k = 0; k < kPoseSignals; ++k) {
            const std::size_t id = i * kPoseSignals + k;
            const double value = std::round(now[k] / kBodyQuantum[k]) * kBodyQuantum[k];
            if (value == poses[id]) continue;
            poses[id] = value;
            for (const auto port : pose_ports)
                outbox.push_back(
                    {next_step + kStep, port, cosim::Signal{static_cast<std::uint16_t>(id), value}});
        }
    }
}

/// Where virtual boards are, for the infra-red medium alone: it knows where they were at the start.
void WorldNode::Impl::publish_virtual_boards(std::vector<cosim::Message>& outbox) {
    const auto& boards = model.description().virtuals.boards;
    for (std::size_t i = 0; i < boards.size(); ++i) {
        const std::array<double, kPoseSignals> now{boards[i].x, boards[i].y, boards[i].heading};
        for (std::size_t k = 0; k < kPoseSignals; ++k) {
            if (virtual_poses[i][k] == now[k]) continue;
            virtual_poses[i][k] = now[k];
            outbox.push_back({next_step + kStep, pose_ports.front(),
                              cosim::Signal{static_cast<std::uint16_t>(virtual_board_signal(i, k)), now[k]}});
        }
    }
}

void WorldNode::Impl::publish_body(std::size_t id, double value, std::vector<cosim::Message>& outbox) {
    double& last = scene[id];
    if (value == last) return;
    last = value;
    for (const auto port : pose_ports)
        outbox.push_back({next_step + kStep, port, cosim::Signal{static_cast<std::uint16_t>(id), value}});
}

/// What events change, for the infra-red medium.
void WorldNode::Impl::publish_scene(std::vector<cosim::Message>& outbox) {
    if (pose_ports.empty() || !timeline.active()) return;
    publish_virtual_boards(outbox);
    const std::size_t moving = poses.size() / kPoseSignals;
    const SceneSignals ids{moving};
    const auto body = [&](bool fixed, std::size_t index, const Shape& shape) {
        const std::size_t first = ids.shape(fixed, index);
        if (first + kShapeSignals > kUnusedSignal) return;  // more than eight thousand things
        const ShapeValues values = values_of(shape);
        for (std::size_t k = 0; k < kShapeSignals; ++k)
            publish_body(first + k, values[k], outbox);
    };
    for (std::size_t i = 0; i < links.size(); ++i)
        publish_body(ids.out(i), model.robot(i).lifted() ? 1.0 : 0.0, outbox);
    for (std::size_t i = 0; i < model.object_names().size(); ++i) {
        const Shape& shape = model.object_shape(i);
        if (links.size() + i < moving)
            publish_body(ids.out(links.size() + i), shape.height > 0.0 ? 0.0 : 1.0, outbox);
        else
            body(false, i - (moving - links.size()), shape);
    }
    for (std::size_t i = 0; i < model.fixed_count(); ++i)
        body(true, i, model.fixed(i));
}

WorldNode::WorldNode(World description, EventPlan plan, std::unique_ptr<CommandSource> commands,
                     PosePorts media, std::optional<TrackerPlan> tracker)
    : impl_(std::make_unique<Impl>(std::move(description), std::move(plan), std::move(commands), media,
                                   std::move(tracker))) {}

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
        for (; next != w.waiting.end() && next->time < w.next_step; ++next)
            w.take(*next);
        w.step();
        w.publish_events(outbox);
        w.publish(outbox);
        w.publish_poses(outbox);
        w.publish_scene(outbox);
        w.sound.publish(w.model, w.next_step + kStep, outbox);
        if (w.cameras) w.cameras->publish(w.model, w.timeline.active(), w.next_step + kStep, outbox);
        w.model.done(StepPart::Publish);
    }
    w.waiting.erase(w.waiting.begin(), next);
}

cosim::Time WorldNode::earliest_output(cosim::PortIndex port) const {
    if (port == impl_->messages && !impl_->timeline.plan().may_send()) return cosim::kNever;
    if (port >= impl_->first_camera) return next_camera_message(impl_->next_step + kStep);
    return std::min(impl_->next_step + kStep, impl_->timeline.next_signal());
}

cosim::Time WorldNode::lookahead(cosim::PortIndex port) const {
    if (port == impl_->messages && !impl_->timeline.plan().may_send()) return cosim::kNever;
    return kStep + 1;  // a message just before a step shows one step after it
}

void WorldNode::observe(StepObserver* observer) {
    impl_->model.observe(observer);
}

std::optional<cosim::Stop> WorldNode::stop() const {
    return impl_->overhead == nullptr ? std::nullopt : impl_->overhead->stop();
}

std::string WorldNode::finish() {
    const auto& model = impl_->model;
    impl_->timeline.end();
    impl_->log.end(model);
    if (impl_->recorder) impl_->recorder->end(model);
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
            auto& pushed_robot = report["robots"].back();
            pushed_robot["pushes"] = floor.pushes();
            pushed_robot["pushed_x_m"] = floor.pushed()[0];
            pushed_robot["pushed_y_m"] = floor.pushed()[1];
            pushed_robot["pushed_theta_rad"] = floor.pushed()[2];
        }
    }
    report["ode_messages"] = model.dynamics().ode_warnings();
    if (model.dynamics().ode_warnings() > 0)
        report["ode_first_message"] = model.dynamics().first_ode_warning();
    if (impl_->timeline.active()) add_events(impl_->timeline.journal(), report);
    if (impl_->overhead != nullptr)
        if (const std::string mission = impl_->overhead->finish(model.seconds()); !mission.empty())
            report["mission"] = nlohmann::ordered_json::parse(mission);
    return report.dump();
}

}  // namespace puckloop::physics
