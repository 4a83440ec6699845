#pragma once
// A serial line seen by a receiver with a baud rate of its own.

#include "cosim/message.h"

#include <cstdint>

namespace puckloop::exec {

/// What an 8N1 receiver takes out of a frame.
struct Sampled {
    std::uint8_t byte = 0;
    bool clean = true;  ///< start bit low and stop bit high where the receiver looked
};

/// Samples `frame` in the middle of each of the receiver's own bits of `bit_period` picoseconds. After the
/// frame the line is taken to be idle.
Sampled sample(const cosim::UartFrame& frame, cosim::Time bit_period);

/// The 8N1 frame of a sender at `bit_period`, its start bit at `start`.
cosim::UartFrame frame_of(std::uint8_t byte, cosim::Time start, cosim::Time bit_period);

/// When the frame's stop bit begins.
cosim::Time stop_bit(const cosim::UartFrame& frame);

}  // namespace puckloop::exec
