#pragma once
// The chips' own UART models without their processors: registers are set and read as a driver does it.

#include "cosim/core/clock.h"
#include "tests/framing/uart_line.h"

#include <memory>
#include <string>
#include <vector>

namespace puckloop::framing {

class UartChip {
  public:
    virtual ~UartChip() = default;

    /// Switches the unit on, with `divisor` chip clocks a tick. Once only.
    virtual void set(const Format& format, std::uint32_t divisor) = 0;
    /// A frame on the receiver's line, handed in when its stop bit begins; time goes on to there.
    void receive(const cosim::UartFrame& frame);
    /// The same, handed in later.
    virtual void deliver(const cosim::UartFrame& frame, cosim::Time at) = 0;
    virtual void run_to(cosim::Time time) = 0;
    /// Everything in the receive buffer, with the flags that the driver reads beside each character.
    virtual std::vector<Character> take() = 0;
    /// One word to the transmitter, if it has room.
    virtual bool send(std::uint16_t data) = 0;
    /// What left the transmitter.
    virtual const std::vector<cosim::UartFrame>& sent() const = 0;

    virtual const cosim::ClockDomain& clock() const = 0;
    virtual int ticks() const = 0;  ///< in a bit
    /// Start of tick `n` of the sampling clock since set().
    cosim::Time tick(std::int64_t n) const {
        return clock().time_of(phase_ + divisor_ * static_cast<std::uint64_t>(n));
    }
    double bit_seconds() const { return ticks() * divisor_ / clock().hertz() / (1 + clock().ppm() * 1e-6); }

  protected:
    std::uint64_t phase_ = 0;
    std::uint32_t divisor_ = 1;
};

struct ChipKind {
    const char* name;
    int ticks;
    std::vector<Format> formats;
    std::unique_ptr<UartChip> (*make)(double ppm);
};
/// dsPIC30F (16 ticks a bit), dsPIC33FJ (16, and 4 with BRGH), ATmega1284P (16, and 8 with U2X).
const std::vector<ChipKind>& chip_kinds();

}  // namespace puckloop::framing
