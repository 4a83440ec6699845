#include "linuxboard/control/devices/posix_i2c.h"

#include <array>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <linux/i2c-dev.h>
#include <linux/i2c.h>
#include <stdexcept>
#include <sys/ioctl.h>
#include <unistd.h>

namespace puckloop::control {

PosixI2c::PosixI2c(const std::string& bus, std::uint16_t address) : address_(address) {
    descriptor_ = ::open(bus.c_str(), O_RDWR | O_CLOEXEC);
    if (descriptor_ < 0) throw std::runtime_error(bus + ": " + std::strerror(errno));
    // What is no I2C bus refuses this; an adapter without combined transfers refuses those.
    if (::ioctl(descriptor_, I2C_TIMEOUT, kI2cPatience) < 0) {
        const std::string reason = bus + ": expected an I2C bus: " + std::strerror(errno);
        ::close(descriptor_);
        throw std::runtime_error(reason);
    }
}

PosixI2c::~PosixI2c() {
    ::close(descriptor_);
}

int PosixI2c::transfer(std::span<const I2cMessage> messages) {
    std::array<i2c_msg, I2C_RDWR_IOCTL_MAX_MSGS> raw{};
    if (messages.size() > raw.size()) return EINVAL;
    for (std::size_t i = 0; i < messages.size(); ++i) {
        raw[i].addr = address_;
        raw[i].flags = messages[i].read ? I2C_M_RD : 0;
        raw[i].len = static_cast<std::uint16_t>(messages[i].bytes.size());
        raw[i].buf = messages[i].bytes.data();
    }
    i2c_rdwr_ioctl_data request{raw.data(), static_cast<std::uint32_t>(messages.size())};
    const int done = ::ioctl(descriptor_, I2C_RDWR, &request);
    if (done < 0) return errno;
    return done == static_cast<int>(messages.size()) ? 0 : EIO;
}

}  // namespace puckloop::control
