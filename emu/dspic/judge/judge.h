#pragma once
// Whether a program that goes round in a loop can ever leave it.
//
// A loop is hung when nothing that it waits for can change: bits that no model drives; flags of sources that
// are off; pins whose level is fixed; RAM that only interrupt routines write which cannot come; or when it is
// endless and no interrupt can come. A loop that waits for anything else is waiting, however long: for a
// byte on a UART, for a flag that a timer's routine sets.
//
// RAM is judged by the routines that name it (routines.h). Where none does, and any interrupt can come, the
// loop counts as waiting: a routine may write through a pointer.

#include "emu/dspic/core/core.h"
#include "emu/dspic/judge/wait_report.h"
#include "emu/dspic/layouts/layout.h"
#include "emu/dspic/waits/wait_watch.h"

#include <optional>

namespace puckloop::dspic {

/// The chip as the judge looks at it.
struct WaitContext {
    const DeviceInfo& device;
    const Layout& layout;
    const SfrSpace& sfr;
    const InterruptController& interrupts;
    const Core& core;
    const Ports& ports;
    const Pins& pins;
};

/// The stay of the program at CPU level `level`, judged.
WaitReport judge(const WaitContext& chip, const LoopFinding& finding, int level);
/// The chip sleeps: true if no enabled interrupt can wake it.
bool sleeps_for_ever(const WaitContext& chip);
/// Why the source of an interrupt cannot raise it as things stand; nothing if it can, or if that is not
/// known.
std::optional<std::string> why_silent(const WaitContext& chip, int irq);
/// The register that switches the source of an interrupt on; 0 if that is not known.
std::uint16_t control_register(const WaitContext& chip, int irq);

}  // namespace puckloop::dspic
