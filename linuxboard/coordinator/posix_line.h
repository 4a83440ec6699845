#pragma once
// The serial port of the XBee module: 9600 8N1, raw, no flow control, the system's monotonic clock. Nothing
// here waits without a limit, whatever is at the other end.

#include "linuxboard/control/devices/transport.h"

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::coordinator {

class PosixLine : public control::Transport {
  public:
    /// Opens and configures the port, and discards what it had received so far. Throws std::runtime_error
    /// naming the port.
    explicit PosixLine(const std::string& port);
    /// Waits at most a second for what was written to leave.
    ~PosixLine() override;
    PosixLine(const PosixLine&) = delete;
    PosixLine& operator=(const PosixLine&) = delete;

    double now() override { return clock_.now(); }
    void sleep_until(double time) override { clock_.sleep_until(time); }
    /// Also sends what the port did not take before.
    std::size_t read(std::span<std::uint8_t> into, double until) override;
    /// Never waits: what the port does not take now is sent by read(). Throws control::LineError when the
    /// port has taken nothing for five seconds.
    void write(std::span<const std::uint8_t> bytes) override;

  private:
    void send_waiting();

    control::PosixClock clock_;
    std::string port_;
    int descriptor_ = -1;
    std::vector<std::uint8_t> waiting_;
    double stuck_since_ = 0;
};

}  // namespace puckloop::coordinator
