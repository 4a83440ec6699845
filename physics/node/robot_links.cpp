#include "physics/node/robot_links.h"

#include <map>
#include <string>
#include <string_view>

namespace puckloop::physics {

namespace {
constexpr const char* kBattery = "battery_v";
constexpr double kBatteryStep = 0.01;  // V
}  // namespace

RobotLinks links_of(const Robot& robot, cosim::PortIndex board) {
    RobotLinks links;
    const auto id_of = [](const std::map<std::string, std::uint16_t>& ids, std::string_view name) {
        const auto found = ids.find(std::string(name));
        return found == ids.end() ? kUnusedSignal : found->second;
    };
    links.wheel = {id_of(robot.board_signals, "wheel_left"), id_of(robot.board_signals, "wheel_right")};
    links.input = {id_of(robot.board_signals, "selector"), id_of(robot.board_signals, "reset"),
                   id_of(robot.board_signals, "remote")};
    const bool has_voltage = robot.board_signals.contains(kBattery);
    for (std::size_t channel = 0; channel < kChannelCount; ++channel) {
        if (channel == kBatteryLowChannel && has_voltage) continue;  // the board derives it
        const auto name = channel_name(channel);
        if (const auto id = id_of(robot.board_signals, name); id != kUnusedSignal)
            links.outputs.push_back({channel, board, id, silent_at_zero(channel) ? 0.0 : std::nan("")});
        if (const auto id = id_of(robot.ground_signals, name); id != kUnusedSignal)
            links.outputs.push_back({channel, static_cast<cosim::PortIndex>(board + 1), id});
    }
    return links;
}

bool hears_battery(const Robot& robot) {
    return robot.rab && robot.rab_signals.contains(kBattery);
}

void add_battery(RobotLinks& links, const Robot& robot, cosim::PortIndex port) {
    links.outputs.push_back({.channel = kBatteryVoltageChannel,
                             .port = port,
                             .id = robot.rab_signals.at(kBattery),
                             .quantum = kBatteryStep});
}

void RobotLinks::publish(const Channels& channels, double count_quantum, cosim::Time time,
                         std::vector<cosim::Message>& outbox) {
    for (Output& output : outputs) {
        const double now = channels[output.channel];
        if (now == output.unrounded) continue;
        output.unrounded = now;
        const double quantum =
            output.quantum > 0.0 ? output.quantum : channel_quantum(output.channel, count_quantum);
        const double value = std::round(now / quantum) * quantum;
        if (value == output.last) continue;
        output.last = value;
        outbox.push_back({time, output.port, cosim::Signal{output.id, value}});
    }
}

}  // namespace puckloop::physics
