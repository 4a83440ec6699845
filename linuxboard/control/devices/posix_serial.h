#pragma once
// The serial line of a real Linux board: a tty at 115200 8N1, raw, with the system's monotonic clock.

#include "linuxboard/control/devices/transport.h"

#include <string>

namespace puckloop::control {

class PosixSerial : public Transport {
  public:
    /// Opens and configures the device, and discards what it had received so far. Throws std::runtime_error
    /// naming the device.
    explicit PosixSerial(const std::string& device);
    ~PosixSerial() override;
    PosixSerial(const PosixSerial&) = delete;
    PosixSerial& operator=(const PosixSerial&) = delete;

    double now() override { return clock_.now(); }
    void sleep_until(double time) override { clock_.sleep_until(time); }
    std::size_t read(std::span<std::uint8_t> into, double until) override;
    void write(std::span<const std::uint8_t> bytes) override;

  private:
    PosixClock clock_;
    std::string device_;
    int descriptor_ = -1;
};

}  // namespace puckloop::control
