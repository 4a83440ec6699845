#pragma once
// What can happen to a core, and who hears of it.

#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/machine/interrupts.h"

#include <cstdint>
#include <functional>
#include <string_view>

namespace puckloop::dspic {

enum class ResetCause : std::uint8_t {
    PowerOn,
    BrownOut,
    Mclr,
    Software,
    Watchdog,
    TrapConflict,
    IllegalOpcode
};
std::string_view to_string(ResetCause cause);

enum class PowerMode : std::uint8_t { Run, Idle, Sleep };

/// What happened inside, for logs and reports. All optional.
struct CoreObserver {
    /// `pc`: of the instruction that caused it.
    std::function<void(ResetCause cause, std::uint32_t pc, Cycle now)> on_reset;
    std::function<void(Trap trap, std::uint32_t pc, Cycle now)> on_trap;
    std::function<void(int vector, std::uint32_t pc, Cycle now)> on_interrupt;
    /// One line, at most once each: "0xDA4000 (debugger break) executed as NOP", ...
    std::function<void(std::string_view text, std::uint32_t pc)> on_warning;
};

}  // namespace puckloop::dspic
