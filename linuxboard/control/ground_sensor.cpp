#include "linuxboard/control/ground_sensor.h"

#include "linuxboard/control/i2c_device.h"

#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <unistd.h>

namespace puckloop::control {

namespace {

constexpr unsigned long kAddress = 0x60;

}  // namespace

GroundSensor::GroundSensor(const std::string& bus) {
    descriptor_ = ::open(bus.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor_ < 0) throw std::runtime_error(bus + ": " + std::strerror(errno));
    if (::ioctl(descriptor_, I2C_SLAVE, kAddress) < 0 ||
        ::ioctl(descriptor_, I2C_TIMEOUT, kI2cPatience) < 0) {
        const std::string reason = bus + ": expected an I2C bus: " + std::strerror(errno);
        ::close(descriptor_);
        throw std::runtime_error(reason);
    }
}

GroundSensor::~GroundSensor() {
    ::close(descriptor_);
}

std::optional<std::array<double, 3>> GroundSensor::read() {
    std::array<std::uint8_t, 6> registers{};
    for (std::uint8_t number = 0; number < registers.size(); ++number) {
        if (::write(descriptor_, &number, 1) != 1 || ::read(descriptor_, &registers[number], 1) != 1) {
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
