#pragma once
// Which frames of one direction of a link a fault is meant for, by what they carry and where they are.

#include "cosim/core/message.h"
#include "cosim/faults/spec/fault_spec.h"

#include <cstdint>
#include <limits>
#include <vector>

namespace puckloop::cosim {

/// Start, data, parity and stop bits.
int bits_of(const UartFrame& frame);
Time frame_time(const UartFrame& frame);
Time frame_time(const RadioFrame& frame);

/// Counts bytes within records: bytes sent without a pause of a whole frame between them.
class RecordCount {
  public:
    /// The frame's place in its record, from 0. To be asked once for each frame, in order.
    std::uint32_t place(const UartFrame& frame);
    /// Bytes of the record before; 0 in the first one.
    std::uint32_t last_length() const { return last_length_; }

  private:
    Time next_ = std::numeric_limits<Time>::min() / 2;  // end of the newest frame
    std::uint32_t sent_ = 0, last_length_ = 0;
};

class FrameMatch {
  public:
    explicit FrameMatch(const FaultSpec& spec);

    /// To be asked once for each frame, in order.
    bool operator()(const UartFrame& frame);
    bool operator()(const RadioFrame& frame) const;

  private:
    bool after_pattern(std::uint8_t byte);

    const FaultSpec& spec_;
    RecordCount records_;
    std::vector<std::uint8_t> newest_{};  // as many as the pattern has
    std::vector<std::uint32_t> due_{};    // bytes still to come until one that is meant
};

}  // namespace puckloop::cosim
