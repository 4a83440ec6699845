#pragma once
// What a receiver makes of the recorded frames of one UART line: bytes and errors.
//
// The receiver is set as the line's sender is: bit time and format of the newest frame that no fault harmed;
// before the first such frame as is assumed, or else by the frame itself with eight data bits.
// A frame that a fault harmed is sampled as a receiver samples it, in the middle of its own bits; others are
// taken as they were sent. Deviation: each frame is sampled as if the line rested behind it.

#include "cosim/trace/trace_row.h"
#include "protocols/serial/uart_sampling.h"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::tools {

class LineReceiver {
  public:
    /// The characters of one frame, in the order of the trace: none of a frame that did not arrive, or whose
    /// start bit is too short; several of one that is much slower than the receiver.
    std::vector<protocols::ReceivedCharacter> take(const cosim::TraceRow& row, const cosim::UartFrame& frame);

    /// Until a frame states otherwise.
    void assume(const protocols::UartReceiver& receiver) {
        if (!receiver_) receiver_ = receiver;
    }

  private:
    std::optional<protocols::UartReceiver> receiver_;
    cosim::Time ready_ = 0;
};

/// How a receiver of this sender is set; nothing for a frame that states nothing of it.
std::optional<protocols::UartReceiver> setting_of(const cosim::TraceRow& row, const cosim::UartFrame& frame);

/// A frame that was on the air; null for other rows, and for what a module gives its medium of its settings
/// (a frame without a duration).
const cosim::RadioFrame* radio_on_air(const cosim::TraceRow& row);
/// The packet that a computer hands to its network; nullptr for anything else, and where it arrives: each is
/// there once.
const cosim::Packet* sent_packet(const cosim::TraceRow& row);

/// "break", "framing error", "wrong parity"; empty: nothing is wrong.
std::string line_error(const protocols::ReceivedCharacter& character);

}  // namespace puckloop::tools
