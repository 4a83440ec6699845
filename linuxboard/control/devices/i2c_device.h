#pragma once
// One board on the Linux board's I2C bus. The real one is posix_i2c.h; tests bring a simulated board.

#include <cstdint>
#include <span>

namespace puckloop::control {

/// I2C_TIMEOUT in units of 10 ms. Many adapters give up a message after it, so that a bus that hangs does not
/// keep the control loop for longer; i2c-omap waits its own second all the same. A board's longest stretch is
/// some milliseconds.
inline constexpr unsigned long kI2cPatience = 3;

struct I2cMessage {
    bool read = false;
    std::span<std::uint8_t> bytes;  ///< to write, or to fill
};

class I2cDevice {
  public:
    virtual ~I2cDevice() = default;

    /// One bus operation: the messages in order, with repeated starts between them and one stop, so that no
    /// other master gets in between. 0, or the errno value of what went wrong; then what was read is void.
    virtual int transfer(std::span<const I2cMessage> messages) = 0;
};

}  // namespace puckloop::control
