#include "emu/i2c_devices/bus_node.h"

#include "base/error.h"
#include "cosim/i2c/i2c_bus.h"
#include "emu/i2c_devices/ground_sensor.h"
#include "emu/i2c_devices/lsm330.h"
#include "emu/i2c_devices/rgb_turret.h"

#include <fmt/format.h>

namespace puckloop::i2c_devices {

namespace {

constexpr double kSlowest = 1e3;  // Hz
constexpr double kFastest = 3.4e6;
constexpr cosim::PortIndex kMainBoard = 0;  // "pic" among the masters
constexpr int kHighestAddress = 0x77;       // 7-bit addresses above are reserved

void check(const BusSpec& spec) {
    const auto fail = [&](const std::string& problem, const std::string& expected) {
        throw InputError("", "I2C bus " + spec.name, problem, expected);
    };
    if (!(spec.hertz >= kSlowest && spec.hertz <= kFastest))
        fail(fmt::format("clock {} Hz", spec.hertz), "1 kHz to 3.4 MHz");
    for (const BoardOnBus& board : spec.boards)
        if (board.address.value_or(0) > kHighestAddress)
            fail(fmt::format("board {} at address {:#x}", board.name, *board.address),
                 "a 7-bit address up to 0x77");
}

}  // namespace

std::unique_ptr<cosim::Node> make_bus_node(const BusSpec& spec) {
    check(spec);
    cosim::I2cBusOptions options;
    options.name = spec.name;
    options.nominal_hertz = spec.hertz;
    options.log = spec.log;
    options.faults = spec.faults;
    options.masters = {{"pic", false}, {"linux", true}};
    for (const BoardOnBus& board : spec.boards) {
        options.devices.push_back({board.name, {}, board.prompt});
        if (board.address) options.devices.back().addresses.push_back(*board.address);
        if (board.main_board) options.devices.back().master = kMainBoard;
    }
    std::vector<std::unique_ptr<cosim::I2cSlave>> slaves;
    if (spec.ground_sensor) slaves.push_back(std::make_unique<GroundSensor>());
    if (spec.rgb_turret) slaves.push_back(std::make_unique<RgbTurret>());
    if (spec.lsm330)
        for (const auto die : {Lsm330::Die::Accelerometer, Lsm330::Die::Gyroscope})
            slaves.push_back(std::make_unique<Lsm330>(die, spec.seed, spec.name));
    return std::make_unique<cosim::I2cBusNode>(std::move(options), std::move(slaves));
}

}  // namespace puckloop::i2c_devices
