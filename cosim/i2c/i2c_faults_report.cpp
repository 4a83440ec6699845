// Evidence: which bytes suffered.

#include "cosim/i2c/i2c_faults.h"

#include "cosim/trace/trace_row.h"

#include <fmt/format.h>

namespace puckloop::cosim {

void I2cFaults::note(std::size_t index, PortIndex master, const I2cPhase& phase, int bit,
                     const std::string& more) {
    carried_[index].fired(phase.start, phases_, describe(master, phase, bit) + more);
}

/// A line that is low counts once, with the first byte that it spoils.
void I2cFaults::pulled(std::size_t index, PortIndex master, const I2cPhase& phase) {
    Fault& fault = faults_[index];
    if (fault.counted == fault.low_from) return;
    fault.counted = fault.low_from;
    std::string more = fmt::format(" low from {}", format_seconds(fault.low_from));
    if (fault.low_until != kNever) more += fmt::format(" until {}", format_seconds(fault.low_until));
    note(index, master, phase, -1, more);
}

std::string I2cFaults::describe(PortIndex master, const I2cPhase& phase, int bit) const {
    const std::string who = master < masters_.size() ? masters_[master] : "fault";
    if (phase.kind == I2cPhaseKind::Stop) return who + " finds the bus busy";
    std::string text = fmt::format("{} 0x{:02x}", who, address_);
    if (phase.kind == I2cPhaseKind::Start)
        text += fmt::format(" address byte 0x{:02x}", phase.byte);
    else if (phase.kind == I2cPhaseKind::Write)
        text += fmt::format(" byte {} written 0x{:02x}", position_, phase.byte);
    else
        text += fmt::format(" byte {} read", position_);
    if (const auto reg = current_register()) text += fmt::format(" register 0x{:02x}", *reg);
    if (bit >= 0) text += fmt::format(" bit {}", bit);
    return text;
}

}  // namespace puckloop::cosim
