#pragma once
// The wire between one of the target's UARTs and the bench's end: 8N1 at the bench's own baud rate, or
// at the one that the end's partner has set (a pty).

#include "bench/logs.h"
#include "bench/targets/target.h"
#include "cosim/core/message.h"
#include "ends/uart_end.h"
#include "protocols/serial/uart_line.h"

#include <memory>
#include <vector>

namespace puckloop::exec {

class UartLine {
  public:
    /// `unit` 1 or 2; `logs` may be null.
    UartLine(int unit, double baud, Target& target, Logs* logs);

    void attach(std::unique_ptr<UartEnd> end) { end_ = std::move(end); }
    UartEnd* end() { return end_.get(); }

    /// When the next frame towards the chip has its stop bit: the moment to call deliver().
    cosim::Time due() const;
    void deliver();
    /// The chip sent a frame.
    void sent(const cosim::UartFrame& frame);
    /// Once a simulated millisecond: receiver errors are logged, the end looks outside.
    void poll(cosim::Time now);

    std::uint64_t bytes_to_chip() const { return to_chip_; }
    std::uint64_t bytes_from_chip() const { return from_chip_; }
    std::uint64_t framing_errors_seen() const {
        return bad_frames_;
    }  ///< by the bench, in what the chip sent

  private:
    cosim::Time start_of_next() const;
    cosim::Time period_of_next() const;
    protocols::UartReceiver receiver() const;
    void heard(const std::vector<protocols::ReceivedCharacter>& characters);
    void watch_receiver(cosim::Time now);
    void log(cosim::Time time, const char* direction, int byte, const char* error);

    int unit_;
    cosim::Time bit_period_;
    Target& target_;
    Logs* logs_;
    std::unique_ptr<UartEnd> end_;
    cosim::Time free_ = 0;  ///< when the line towards the chip is idle again
    protocols::UartListener listener_;
    cosim::Time listening_since_ = cosim::kNever;
    std::size_t resets_ = 0;
    dspic::UartCounters counters_;
    std::uint64_t to_chip_ = 0;
    std::uint64_t from_chip_ = 0;
    std::uint64_t bad_frames_ = 0;
};

}  // namespace puckloop::exec
