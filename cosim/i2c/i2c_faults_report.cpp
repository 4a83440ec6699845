// Evidence: which bytes suffered.

#include "cosim/i2c/i2c_faults.h"

#include "cosim/trace/trace_row.h"

#include <fmt/format.h>

namespace puckloop::cosim {

namespace {

std::string low_text(Time from, Time until) {
    std::string text = fmt::format(" low from {}", format_seconds(from));
    if (until != kNever) text += fmt::format(" until {}", format_seconds(until));
    return text;
}

}  // namespace

void I2cFaults::note(std::size_t index, PortIndex master, const I2cPhase& phase, int bit,
                     const std::string& more) {
    carried_[index].fired(phase.start, phases_, describe(master, phase, bit) + more);
}

/// A line that is low counts once, with the first byte that it spoils.
void I2cFaults::pulled(std::size_t index, PortIndex master, const I2cPhase& phase, const std::string& how) {
    Fault& fault = faults_[index];
    if (fault.counted == fault.low_from) return;
    fault.counted = fault.low_from;
    note(index, master, phase, -1, low_text(fault.low_from, fault.low_until) + how);
}

/// A line that was pulled low for its whole time, until `now` at most, without a byte or a START that met it:
/// it was low all the same. Counted at the instant at which it went low.
void I2cFaults::note_quiet(Time now, bool over) {
    for (std::size_t i = 0; i < faults_.size(); ++i) {
        Fault& fault = faults_[i];
        if (!fault.what.timed || fault.counted == fault.low_from || fault.low_from >= now) continue;
        if (fault.low_until > now && !over) continue;
        fault.counted = fault.low_from;
        carried_[i].fired(fault.low_from, phases_,
                          std::string(i2c_fault_name(fault.what.kind)) +
                              low_text(fault.low_from, fault.low_until) + " on a bus at rest");
    }
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
