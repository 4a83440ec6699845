#pragma once
// What the control program needs of a serial line and a clock. The real one is posix_serial.h; tests bring a
// simulated line with a simulated clock.

#include "linuxboard/control/devices/clock.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>

namespace puckloop::control {

/// The line itself failed (hang-up, I/O error): nothing more can be sent or received.
class LineError : public std::runtime_error {
  public:
    using std::runtime_error::runtime_error;
};

class Transport : public Clock {
  public:
    /// Waits until at least one byte is there or the time is `until`; returns the number of bytes read, 0 if
    /// none came (a signal may also end the wait). Throws LineError.
    virtual std::size_t read(std::span<std::uint8_t> into, double until) = 0;
    /// Hands over all bytes. Throws LineError.
    virtual void write(std::span<const std::uint8_t> bytes) = 0;
};

}  // namespace puckloop::control
