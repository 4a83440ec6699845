#include "emu/i2c_devices/ground_sensor.h"

#include "emu/i2c_devices/signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::i2c_devices {

namespace {
constexpr double kFullScale = 1023;  // 10-bit converter
constexpr unsigned kByteBits = 8;
}  // namespace

void GroundSensor::signal(std::uint16_t id, double value) {
    if (id >= kGroundReflected && id < kGroundReflected + counts_.size())
        counts_[id - kGroundReflected] =
            static_cast<std::uint16_t>(std::lround(std::clamp(value, 0.0, kFullScale)));
}

std::uint8_t GroundSensor::read_register(std::uint8_t number) {
    ++reads_;
    if (number < 2 * counts_.size()) {
        const std::uint16_t value = counts_[number / 2u];
        return static_cast<std::uint8_t>(number % 2 == 0 ? value >> kByteBits : value);
    }
    return number == kRevisionRegister ? kRevision : 0;
}

bool GroundSensor::write_register(std::uint8_t, std::uint8_t) {
    return true;  // acknowledged, without effect
}

std::string GroundSensor::report() const {
    return fmt::format(R"({{"registers_read":{},"left":{},"centre":{},"right":{}}})", reads_, counts_[0],
                       counts_[1], counts_[2]);
}

}  // namespace puckloop::i2c_devices
