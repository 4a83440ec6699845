#pragma once
// The three-channel ground sensor board on the Linux board's I2C bus (i2c-dev), address 0x60: registers 0..5
// are left, centre, right, high byte first (fact sheet 2.2).

#include "linuxboard/control/devices/posix_i2c.h"

#include <array>
#include <optional>
#include <string>

namespace puckloop::control {

class GroundSensor {
  public:
    /// Opens the bus device, e.g. "/dev/i2c-3". Throws std::runtime_error naming it.
    explicit GroundSensor(const std::string& bus);

    /// Left, centre, right, 0 black to 1000 white; empty when the board does not answer.
    std::optional<std::array<double, 3>> read();
    unsigned long failures() const { return failures_; }

  private:
    PosixI2c device_;
    unsigned long failures_ = 0;
};

}  // namespace puckloop::control
