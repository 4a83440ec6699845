#pragma once
// The mark that a fault leaves on a message of a link: part of the trace. What faults there are, and their
// parameters, is in kind_table.h.

#include <cstdint>
#include <optional>
#include <string_view>

namespace puckloop::cosim {

/// The numbers are part of the trace's hash: append only.
enum class FaultKind : std::uint8_t {
    None,
    Drop,          ///< the frame never arrives
    Flip,          ///< data bits of the frame are inverted on the way; the parity bit is not
    Delay,         ///< the frame arrives later
    Duplicate,     ///< the frame arrives, and once more one frame time later
    Disconnect,    ///< nothing arrives during the window: the plug is out, the line idles high
    Stuck,         ///< the line stays at one level during the window
    Rate,          ///< the sender's bit time is another
    Cut,           ///< the rest of a record, bytes sent without a pause, never arrives
    Insert,        ///< a byte that nobody sent
    Held,          ///< kept back; comes as another message, after the next one
    Swap,          ///< that other message
    Truncate,      ///< the rest of a record never arrives
    Parity,        ///< another parity bit
    Stop,          ///< the stop bit is low for a while
    Glitch,        ///< the line has the wrong level for a while within the frame
    FalseStart,    ///< a short low pulse on the line at rest
    Break,         ///< the line goes low for longer than a frame
    Invert,        ///< every level is the wrong one, that of the line at rest too
    Unplug,        ///< the plug is out
    Torn,          ///< the plug went out or in during the frame: the line rested for a part of it
    SwappedWires,  ///< transmitter on transmitter, receiver on receiver
    Batch,         ///< comes with others at the end of a period
    Throttle,      ///< waits for its turn on a slower way
    Overflow,      ///< found no room in a queue
    Stall,         ///< waits for the end of the window
    Late,          ///< pushed back by another message that a fault made late
    Baud,          ///< the sender's clock is off
    Loopback,      ///< comes back to its sender: shown on the line into it
};

/// "drop", "flip", ...; empty for None.
std::string_view fault_name(FaultKind kind);
std::optional<FaultKind> fault_of_name(std::string_view name);

constexpr bool keeps_from_arriving(FaultKind kind) {
    switch (kind) {
    case FaultKind::Drop:
    case FaultKind::Disconnect:
    case FaultKind::Stuck:
    case FaultKind::Cut:
    case FaultKind::Held:
    case FaultKind::Truncate:
    case FaultKind::Unplug:
    case FaultKind::SwappedWires:
    case FaultKind::Overflow:
        return true;
    default:
        return false;
    }
}

}  // namespace puckloop::cosim
