// What a CAN bus reports of itself: its controllers' states in the log, counters and warnings.

#include "base/error.h"
#include "base/json.h"
#include "base/text/times_text.h"
#include "cosim/can/can_bus.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::cosim {

namespace {

/// Two clocks further apart than this do not read each other's frames (CAN 2.0 part A, 10: 1.58 %).
constexpr double kMostApart = 0.0158;

double kilobits(const CanTiming& timing) {
    return static_cast<double>(kSecond) / static_cast<double>(timing.bit) / 1e3;
}

}  // namespace

void CanBusNode::watch_state(std::size_t index, Time time) {
    Controller& controller = controllers_[index];
    const CanStation& station = wire_.station(index);
    using State = Controller::State;
    State state = State::Off;
    if (station.on()) state = State::Active;
    if (station.on() && station.passive()) state = State::Passive;
    if (station.on() && station.bus_off()) state = State::BusOff;
    if (state == controller.state) return;
    const State before = std::exchange(controller.state, state);
    if (state == State::BusOff) ++controller.counters.bus_off;
    if (!log_.is_open() || (before == State::Off && state == State::Active)) return;
    constexpr std::array<std::string_view, 4> kNames{"off", "error active", "error passive", "bus-off"};
    write(time,
          fmt::format("{}: {}", options_.controllers[index], kNames.at(static_cast<std::size_t>(state))));
}

std::vector<std::string> CanBusNode::warnings() const {
    std::vector<std::string> lines;
    std::size_t slowest = controllers_.size(), fastest = controllers_.size();
    for (std::size_t i = 0; i < controllers_.size(); ++i) {
        const Controller& controller = controllers_[i];
        const std::string& name = options_.controllers[i];
        const auto nobody =
            controller.counters.errors[static_cast<std::size_t>(protocols::CanError::Acknowledge)];
        if (nobody > 0)
            lines.push_back(
                fmt::format("{} sent a frame {} and nobody acknowledged it", name, times_text(nobody)));
        if (controller.counters.bus_off > 0)
            lines.push_back(fmt::format("{} was bus-off {}", name, times_text(controller.counters.bus_off)));
        if (!controller.joined) continue;
        if (slowest == controllers_.size() || controller.timing.bit > controllers_[slowest].timing.bit)
            slowest = i;
        if (fastest == controllers_.size() || controller.timing.bit < controllers_[fastest].timing.bit)
            fastest = i;
    }
    if (slowest == controllers_.size()) return lines;
    const CanTiming& slow = controllers_[slowest].timing;
    const CanTiming& fast = controllers_[fastest].timing;
    if (static_cast<double>(slow.bit) > static_cast<double>(fast.bit) * (1 + kMostApart))
        lines.push_back(fmt::format("{} is set to {:.6g} kbit/s, {} to {:.6g}: they cannot read each other",
                                    options_.controllers[slowest], kilobits(slow),
                                    options_.controllers[fastest], kilobits(fast)));
    return lines;
}

std::string CanBusNode::finish() {
    wire_.faults().conclude(now_);
    nlohmann::ordered_json json{{"frames", frames_}};
    nlohmann::ordered_json& list = json["controllers"];
    for (std::size_t i = 0; i < controllers_.size(); ++i) {
        const Controller& controller = controllers_[i];
        const Counters& counters = controller.counters;
        nlohmann::ordered_json errors;
        for (std::size_t kind = 1; kind < counters.errors.size(); ++kind)
            if (counters.errors[kind] > 0)
                errors[std::string(can_error_name(static_cast<protocols::CanError>(kind)))] =
                    counters.errors[kind];
        list[options_.controllers[i]] = {
            {"kbit_per_s", controller.joined ? nlohmann::ordered_json(kilobits(controller.timing)) : nullptr},
            {"sent", counters.sent},
            {"received", counters.received},
            {"lost_arbitration", counters.lost},
            {"errors_sending", counters.errors_sending},
            {"errors_receiving", counters.errors_receiving},
            {"errors", std::move(errors)},
            {"bus_off", counters.bus_off},
            {"transmit_errors", wire_.station(i).transmit_errors()},
            {"receive_errors", wire_.station(i).receive_errors()}};
    }
    json["warnings"] = warnings();
    if (!wire_.faults().empty()) json["faults"] = fault_results(wire_.faults().carried(), now_);
    if (log_.is_open()) write(now_, fmt::format("{} frames, {} errors reported", frames_, error_frames_));
    return json.dump();
}

}  // namespace puckloop::cosim
