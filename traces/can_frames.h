#pragma once
// What stood on a CAN bus, from the rows of a trace: the bus reports to the sender of each frame how it
// ended.
//
// Of a frame that failed the bits up to the error are the sender's; the error flag is drawn as six dominant
// bits if the sender was error active. Deviation: longer flags, of several controllers one after the other,
// and dominant bits of a fault are not in the trace and not drawn.

#include "cosim/trace/trace_row.h"
#include "protocols/can/can_reader.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::tools {

struct CanOnBus {
    std::string bus, sender;  ///< "can", "robot0.pic.can1"
    protocols::CanFrame frame;
    cosim::Time start = 0, bit = 0;
    protocols::CanError error = protocols::CanError::None;
    int position = 0;  ///< of the bit with the error
    unsigned transmit_errors = 0, receive_errors = 0;

    /// Dominant stretches, from the start of frame on.
    std::vector<std::pair<cosim::Time, cosim::Time>> dominant() const;
    cosim::Time end() const;
    /// "123#0102", and behind it what was wrong.
    std::string text() const;
    std::string error_text() const;
    /// A frame of Linux' SocketCAN (LINKTYPE_CAN_SOCKETCAN); one that failed is an error frame.
    std::vector<std::uint8_t> socketcan() const;
};

/// nullopt: the row is not what the sender of a frame gets of it.
std::optional<CanOnBus> can_on_bus(const cosim::TraceRow& row);

}  // namespace puckloop::tools
