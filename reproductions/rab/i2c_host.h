#pragma once
// An I2C master that plays short transfers to one range-and-bearing board, straight at the board's device
// port (cosim/i2c/i2c_bus.h). A byte takes nine clocks and what the board stretches them; each transfer ends
// with STOP.
//
// Deviation: nobody else is on the bus; a byte that is not acknowledged ends the transfer.

#include "cosim/core/message.h"

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <vector>

namespace puckloop::tools {

class I2cHost {
  public:
    I2cHost(std::uint8_t address, double clock_hertz);

    /// Queues a write of `bytes` (register first), not before `earliest`.
    void write(cosim::Time earliest, std::vector<std::uint8_t> bytes);
    /// Queues a read of one byte; `done` gets it when it has come, or nothing if the board refused.
    using Done = std::function<void(std::optional<std::uint8_t> byte, cosim::Time now)>;
    void read(cosim::Time earliest, std::uint8_t register_number, Done done);

    /// When the next phase begins; kNever with nothing to do or while the board is thinking.
    cosim::Time due() const;
    /// The phase that begins at due().
    cosim::I2cPhase next();
    void answered(const cosim::I2cPhase& answer, cosim::Time now);

    cosim::Time clock() const { return clock_; }
    std::uint64_t refused() const { return refused_; }

  private:
    struct Step {
        cosim::I2cPhaseKind kind = cosim::I2cPhaseKind::Stop;
        std::uint8_t byte = 0;
    };
    struct Transfer {
        cosim::Time earliest = 0;
        std::vector<Step> steps;
        Done done;
    };
    void finish(std::optional<std::uint8_t> byte, cosim::Time now);

    std::uint8_t address_byte_;
    cosim::Time clock_;
    std::deque<Transfer> queue_;
    std::size_t step_ = 0;
    std::optional<cosim::I2cPhase> open_;
    std::optional<std::uint8_t> byte_;
    cosim::Time free_ = 0;  ///< the next phase begins then at the earliest
    std::uint64_t refused_ = 0;
};

}  // namespace puckloop::tools
