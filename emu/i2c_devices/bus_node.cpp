#include "emu/i2c_devices/bus_node.h"

#include "base/error.h"
#include "cosim/i2c_bus.h"
#include "emu/i2c_devices/ground_sensor.h"
#include "emu/i2c_devices/rgb_turret.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace puckloop::i2c_devices {

namespace {

constexpr double kSlowest = 1e3;  // Hz
constexpr double kFastest = 3.4e6;
constexpr int kHighestAddress = 0x77;  // 7-bit addresses above are reserved

void check(const BusSpec& spec) {
    const auto fail = [&](const std::string& problem, const std::string& expected) {
        throw InputError("", "I2C bus " + spec.name, problem, expected);
    };
    if (!(spec.hertz >= kSlowest && spec.hertz <= kFastest))
        fail(fmt::format("clock {} Hz", spec.hertz), "1 kHz to 3.4 MHz");
    std::vector<int> taken;
    if (spec.ground_sensor) taken.push_back(kGroundSensorAddress);
    if (spec.rgb_turret) taken.push_back(kRgbTurretAddress);
    for (const auto& [name, address] : spec.boards) {
        if (address > kHighestAddress)
            fail(fmt::format("board {} at address {:#x}", name, address), "a 7-bit address up to 0x77");
        if (std::find(taken.begin(), taken.end(), address) != taken.end())
            fail(fmt::format("board {}: address {:#x} is taken", name, address), "another address");
        taken.push_back(address);
    }
}

}  // namespace

std::unique_ptr<cosim::Node> make_bus_node(const BusSpec& spec) {
    check(spec);
    cosim::I2cBusOptions options;
    options.name = spec.name;
    options.nominal_hertz = spec.hertz;
    options.log = spec.log;
    options.masters = {{"pic", false}, {"linux", true}};
    for (const auto& [name, address] : spec.boards)
        options.devices.push_back({name, {address}});
    std::vector<std::unique_ptr<cosim::I2cSlave>> slaves;
    if (spec.ground_sensor) slaves.push_back(std::make_unique<GroundSensor>());
    if (spec.rgb_turret) slaves.push_back(std::make_unique<RgbTurret>());
    return std::make_unique<cosim::I2cBusNode>(std::move(options), std::move(slaves));
}

std::unique_ptr<cosim::Node> make_bus_node(std::string_view text) {
    BusSpec spec;
    try {
        const auto json = nlohmann::json::parse(text);
        spec.name = json.value("name", spec.name);
        spec.ground_sensor = json.value("ground_sensor", spec.ground_sensor);
        spec.rgb_turret = json.value("rgb_turret", spec.rgb_turret);
        spec.hertz = json.value("hertz", spec.hertz);
        spec.log = json.value("log", spec.log);
        for (const auto& board : json.value("boards", nlohmann::json::array()))
            spec.boards.emplace_back(board.at("name").get<std::string>(),
                                     board.at("address").get<std::uint8_t>());
    } catch (const nlohmann::json::exception& error) {
        throw InputError("", "I2C bus description", error.what());
    }
    return make_bus_node(spec);
}

}  // namespace puckloop::i2c_devices
