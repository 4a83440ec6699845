#pragma once
// What a trace has of one range-and-bearing board's I2C traffic: registers read and written, and when the
// board's firmware served the bus and did nothing else. Registers: the e-RandB's (docs/rab.md).

#include "cosim/core/time.h"
#include "cosim/trace/trace_row.h"

#include <cstdint>
#include <vector>

namespace puckloop::tools {

/// One byte read from or written to a register.
struct RegisterAccess {
    cosim::Time end = 0;  ///< of the byte on the wires
    bool read = false;
    std::uint8_t number = 0;
    std::uint8_t value = 0;
};

/// A stretch of time in which the interrupt routine at the highest priority holds the processor.
struct Busy {
    cosim::Time begin = 0, end = 0;
};

class BoardBus {
  public:
    /// A row of the link between bus and board, in the order of the trace.
    void add(const cosim::TraceRow& row);

    const std::vector<RegisterAccess>& accesses() const { return accesses_; }
    /// In order; the routine waits while a byte is clocked out of it, and while it holds SCL.
    const std::vector<Busy>& busy() const { return busy_; }

  private:
    void answered(const cosim::I2cPhase& answer, cosim::Time now);

    cosim::I2cPhase asked_{};  // the last phase that the board is to answer
    bool addressed_ = false;
    bool pointer_next_ = false;
    std::uint8_t pointer_ = 0;
    std::vector<RegisterAccess> accesses_;
    std::vector<Busy> busy_;
};

}  // namespace puckloop::tools
