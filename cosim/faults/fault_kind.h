#pragma once
// What a fault on a link does to a message.

#include <cstdint>
#include <optional>
#include <string_view>

namespace puckloop::cosim {

enum class FaultKind : std::uint8_t {
    None,
    Drop,        ///< the frame never arrives
    Flip,        ///< one data bit of the frame is inverted on the way; the parity bit is not
    Delay,       ///< the frame arrives later by the fault's amount (s)
    Duplicate,   ///< the frame arrives, and once more one frame time later
    Disconnect,  ///< nothing arrives during the window: the plug is out, the line idles high
    Stuck,       ///< the line is low during the window: one break, then nothing
    Rate,        ///< the sender's bit time is multiplied by the fault's amount
    Cut,         ///< the rest of a record, bytes sent without a pause, never arrives
};

/// "drop", "flip", ...; empty for None.
std::string_view fault_name(FaultKind kind);
std::optional<FaultKind> fault_of_name(std::string_view name);

constexpr bool keeps_from_arriving(FaultKind kind) {
    return kind == FaultKind::Drop || kind == FaultKind::Disconnect || kind == FaultKind::Stuck ||
           kind == FaultKind::Cut;
}

}  // namespace puckloop::cosim
