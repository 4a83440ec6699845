#include "linuxboard/control/devices/ground_sensor.h"

#include <cstdint>

namespace puckloop::control {

namespace {

constexpr std::uint16_t kAddress = 0x60;

}  // namespace

GroundSensor::GroundSensor(const std::string& bus) : device_(bus, kAddress) {}

std::optional<std::array<double, 3>> GroundSensor::read() {
    std::array<std::uint8_t, 6> registers{};
    for (std::uint8_t number = 0; number < registers.size(); ++number) {
        // Two transfers, each with its own STOP, as the robot's known programs do.
        const I2cMessage ask{false, {&number, 1}};
        const I2cMessage answer{true, {&registers[number], 1}};
        if (device_.transfer({&ask, 1}) != 0 || device_.transfer({&answer, 1}) != 0) {
            ++failures_;
            return std::nullopt;
        }
    }
    std::array<double, 3> values{};
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = registers[2 * i] * 256.0 + registers[2 * i + 1];
    return values;
}

}  // namespace puckloop::control
