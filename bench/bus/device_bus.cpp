#include "bench/bus/device_bus.h"

#include "base/json.h"
#include "cosim/i2c/i2c_bus.h"
#include "emu/i2c_devices/ground_sensor.h"
#include "emu/i2c_devices/lsm330.h"
#include "emu/i2c_devices/rgb_turret.h"
#include "emu/i2c_devices/signals.h"
#include "emu/rab_board/rab_node.h"

#include <algorithm>

namespace puckloop::exec {

using cosim::PortIndex;
using cosim::Time;

namespace {

/// The fastest master there is, so that no answer comes later than it would on the wires.
constexpr double kFastestHertz = 400e3;
constexpr std::size_t kBus = 0;           // in parts_
constexpr std::size_t kTargetVertex = 0;  // of the graph that Bounds sees; part n is vertex n + 1
constexpr PortIndex kMaster = 0;          // the bus's ports: the target, the boards, the world
constexpr std::uint16_t kGroundSignals = i2c_devices::kRgb;
constexpr std::uint16_t kTurretSignals = i2c_devices::kAcceleration - i2c_devices::kRgb;
constexpr std::uint16_t kLsm330Signals = i2c_devices::kSignalCount - i2c_devices::kAcceleration;

}  // namespace

DeviceBus::DeviceBus(const std::vector<I2cDeviceSpec>& devices, const Options& options, Emit emit)
    : emit_(std::move(emit)) {
    cosim::I2cBusOptions bus;
    bus.nominal_hertz = kFastestHertz;
    bus.masters = {{"target", false}};
    std::vector<std::unique_ptr<cosim::I2cSlave>> slaves;
    parts_.emplace_back();
    for (const I2cDeviceSpec& spec : devices)
        if (spec.kind == I2cDeviceSpec::Kind::Rab) {
            bus.devices.push_back({"rab", {}});
            if (spec.address) bus.devices.back().addresses.push_back(*spec.address);
            add_board(spec, options);
        }
    const auto world = static_cast<PortIndex>(parts_.size());
    for (const I2cDeviceSpec& spec : devices) {
        if (spec.kind == I2cDeviceSpec::Kind::Ground) {
            slaves.push_back(std::make_unique<i2c_devices::GroundSensor>(
                spec.address.value_or(i2c_devices::kGroundSensorAddress)));
            add_signals(i2c_devices::signals(), kBus, world, i2c_devices::kGroundReflected, kGroundSignals);
        } else if (spec.kind == I2cDeviceSpec::Kind::Turret) {
            slaves.push_back(std::make_unique<i2c_devices::RgbTurret>(
                spec.address.value_or(i2c_devices::kRgbTurretAddress)));
            add_signals(i2c_devices::signals(), kBus, world, i2c_devices::kRgb, kTurretSignals);
        } else if (spec.kind == I2cDeviceSpec::Kind::Lsm330) {
            using i2c_devices::Lsm330;
            for (const auto die : {Lsm330::Die::Accelerometer, Lsm330::Die::Gyroscope})
                slaves.push_back(std::make_unique<Lsm330>(die, options.seed, "i2c"));
            add_signals(i2c_devices::signals(), kBus, world, i2c_devices::kAcceleration, kLsm330Signals);
        }
    }
    parts_[kBus].node = std::make_unique<cosim::I2cBusNode>(std::move(bus), std::move(slaves));
}

void DeviceBus::add_board(const I2cDeviceSpec& spec, const Options& options) {
    rab::RabNodeOptions board;
    board.board.seed = options.seed;
    board.board.adc_noise_counts = options.adc_noise_counts;
    board.fastest_i2c_hertz = kFastestHertz;
    board.log = options.rab_log;
    parts_.push_back({std::make_unique<rab::RabNode>(image::load_image(spec.image), board)});
    add_signals(rab::signals(), parts_.size() - 1, rab::RabNode::kIr, 0, rab::kPeakReset);
}

void DeviceBus::add_signals(std::span<const cosim::SignalInfo> signals, std::size_t part, PortIndex port,
                            std::uint16_t first, std::uint16_t count) {
    for (std::uint16_t id = first; id < first + count; ++id) {
        signals_.push_back(signals[id]);
        values_.push_back(signals[id].initial);
        places_.push_back({part, port, id});
    }
}

void DeviceBus::set_signal(std::size_t id, double value, Time now) {
    values_[id] = std::clamp(value, signals_[id].min, signals_[id].max);
    const SignalPlace& place = places_[id];
    deliver(place.part, {now, place.port, cosim::Signal{place.id, values_[id]}});
}

void DeviceBus::phase(const cosim::I2cPhase& phase) {
    deliver(kBus, {phase.start, kMaster, phase});
}

void DeviceBus::deliver(std::size_t part, cosim::Message message) {
    auto& inbox = parts_[part].inbox;
    const auto after = std::upper_bound(inbox.begin(), inbox.end(), message.time,
                                        [](Time time, const cosim::Message& m) { return time < m.time; });
    inbox.insert(after, std::move(message));
}

Time DeviceBus::advance(Time now, Time earliest, Time until) {
    for (bool progress = true; progress;) {
        set_channels(now, earliest);
        bounds_.compute(channels_, pending_);
        progress = false;
        for (std::size_t part = 0; part < parts_.size(); ++part)
            progress |= advance_part(part, std::min(bounds_.limit(part + 1), until));
    }
    return std::min({until, bounds_.limit(kTargetVertex), std::max(due(), now)});
}

void DeviceBus::set_channels(Time now, Time earliest) {
    channels_.clear();
    pending_.assign(1, due());
    for (const Part& part : parts_)
        pending_.push_back(part.inbox.empty() ? cosim::kNever : part.inbox.front().time);
    const cosim::Node& bus = *parts_[kBus].node;
    channels_.push_back({kTargetVertex, kBus + 1, std::max(now, earliest), 0});
    channels_.push_back({kBus + 1, kTargetVertex, bus.earliest_output(kMaster), bus.lookahead(kMaster)});
    for (std::size_t part = 1; part < parts_.size(); ++part) {
        const auto port = static_cast<PortIndex>(part);
        const cosim::Node& board = *parts_[part].node;
        channels_.push_back({kBus + 1, part + 1, bus.earliest_output(port), bus.lookahead(port)});
        channels_.push_back({part + 1, kBus + 1, board.earliest_output(rab::RabNode::kI2c),
                             board.lookahead(rab::RabNode::kI2c)});
    }
}

/// True if it went on.
bool DeviceBus::advance_part(std::size_t index, Time until) {
    Part& part = parts_[index];
    if (until <= part.reached) return false;
    const auto later = std::find_if(part.inbox.begin(), part.inbox.end(),
                                    [until](const cosim::Message& message) { return message.time >= until; });
    std::vector<cosim::Message> outbox;
    part.node->advance(until, {part.inbox.begin(), later}, outbox);
    part.inbox.erase(part.inbox.begin(), later);
    part.reached = until;
    for (const cosim::Message& message : outbox)
        route(index, message);
    return true;
}

void DeviceBus::route(std::size_t from, const cosim::Message& message) {
    if (const auto* signal = std::get_if<cosim::Signal>(&message.payload)) {
        for (std::size_t i = 0; i < places_.size(); ++i)
            if (places_[i].part == from && places_[i].id == signal->id) {
                values_[i] = signal->value;
                emit_(signals_[i].name, signal->value, message.time);
            }
    } else if (from != kBus) {
        if (message.port == rab::RabNode::kI2c)
            deliver(kBus, {message.time, static_cast<PortIndex>(from), message.payload});
    } else if (message.port == kMaster) {
        answers_.push_back(message);
    } else if (!is_world(message.port)) {
        deliver(message.port, {message.time, rab::RabNode::kI2c, message.payload});
    }
}

Time DeviceBus::due() const {
    return answers_.empty() ? cosim::kNever : answers_.front().time;
}

cosim::I2cPhase DeviceBus::take() {
    const auto phase = std::get<cosim::I2cPhase>(answers_.front().payload);
    answers_.pop_front();
    return phase;
}

std::string DeviceBus::finish() {
    auto json = nlohmann::ordered_json::parse(parts_[kBus].node->finish());
    for (std::size_t part = 1; part < parts_.size(); ++part)
        json["boards"]["rab"] = nlohmann::ordered_json::parse(parts_[part].node->finish());
    return json.dump();
}

}  // namespace puckloop::exec
