#pragma once
// What a UART receiver makes of a frame on its line: it samples the line in the middle of its own bits.

#include "cosim/core/message.h"
#include "cosim/core/time.h"

#include <cstdint>
#include <functional>
#include <vector>

namespace puckloop::protocols {

/// How a receiver is set.
struct UartReceiver {
    cosim::Time bit_period = 0;  ///< of its own baud-rate generator, picoseconds, > 0
    std::uint8_t data_bits = 8;  ///< 5..9
    std::uint8_t parity = 0;     ///< 0 none, 1 odd, 2 even
};

/// One character as the receiver took it.
struct ReceivedCharacter {
    std::uint16_t data = 0;
    bool framing_error = false;  ///< the stop bit was low
    bool parity_error = false;
    bool is_break = false;  ///< all bits low, stop bit included
    cosim::Time start = 0;  ///< the falling edge that it took for a start bit
    cosim::Time time = 0;   ///< middle of its stop bit: the character is there
};

/// Start, data and parity bits.
int bits_before_stop(const cosim::UartFrame& frame);

/// True where the frame leaves the line at mark. The line is idle before it; after it too, but where the
/// frame states that it rests low.
bool line_is_mark(const cosim::UartFrame& frame, cosim::Time time);

/// The next instant after `time` at which the level may be another: the frame's start, bit boundaries, edges
/// of a glitch, its end; kNever behind that.
cosim::Time next_change(const cosim::UartFrame& frame, cosim::Time time);

/// End of the frame's last stop bit.
cosim::Time frame_end(const cosim::UartFrame& frame);

/// The stop bit begins.
cosim::Time stop_bit_start(const cosim::UartFrame& frame);

/// The character whose start bit begins at `edge`, on a line with these levels.
ReceivedCharacter take_character(const std::function<bool(cosim::Time)>& level, const UartReceiver& receiver,
                                 cosim::Time edge);

/// The characters that a receiver, free from `ready` on, reads out of one frame: usually one; none if the
/// receiver was still busy; several if it is faster than the sender.
///
/// Deviation: every frame is sampled as if the line idled before and after it, so a receiver that is slower
/// than the sender takes the bits of the following frame for mark. For lines whose levels faults have changed
/// there is UartListener (protocols/serial/uart_line.h).
std::vector<ReceivedCharacter> sample_frame(const cosim::UartFrame& frame, const UartReceiver& receiver,
                                            cosim::Time ready);

}  // namespace puckloop::protocols
