#pragma once
// A board on a Linux I2C bus (i2c-dev), by combined transfers (I2C_RDWR).

#include "linuxboard/control/devices/i2c_device.h"

#include <string>

namespace puckloop::control {

class PosixI2c : public I2cDevice {
  public:
    /// Opens the bus device, e.g. "/dev/i2c-3"; `address` has 7 bits. Throws std::runtime_error naming it.
    PosixI2c(const std::string& bus, std::uint16_t address);
    ~PosixI2c() override;
    PosixI2c(const PosixI2c&) = delete;
    PosixI2c& operator=(const PosixI2c&) = delete;

    /// At most 42 messages (the kernel's limit).
    int transfer(std::span<const I2cMessage> messages) override;

  private:
    int descriptor_ = -1;
    std::uint16_t address_;
};

}  // namespace puckloop::control
