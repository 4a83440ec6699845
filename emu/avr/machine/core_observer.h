#pragma once
// What can happen to a core, who hears of it, and what it leaves to others.

#include "emu/avr/machine/interrupts.h"

#include <cstdint>
#include <functional>
#include <string_view>

namespace puckloop::avr {

enum class ResetCause : std::uint8_t { PowerOn, External, BrownOut, Watchdog };
std::string_view to_string(ResetCause cause);

/// What happened inside, for logs and reports. All optional. `pc` counts words.
struct CoreObserver {
    std::function<void(ResetCause cause, std::uint16_t pc, Cycle now)> on_reset;
    std::function<void(int vector, std::uint16_t pc, Cycle now)> on_interrupt;
    /// One line, at most once each: "undefined word 0x9419 executed as NOP", ...
    std::function<void(std::string_view text, std::uint16_t pc)> on_warning;
};

/// What the core leaves to others. All optional.
struct CoreHooks {
    std::function<void(ResetCause)> reset;       ///< before the core resets: everything else resets
    std::function<std::uint16_t()> reset_pc;     ///< word address of the reset vector; 0 without it
    std::function<std::uint16_t()> vector_base;  ///< word address of vector 0; 0 without it
    std::function<bool()> interrupts_locked;     ///< the next instruction is where no interrupt is taken
    std::function<void()> sleep;                 ///< SLEEP: may call Core::sleep()
    std::function<void()> wake;                  ///< clocks that stood still run again from now() on
    std::function<void()> watchdog_reset;        ///< WDR
    /// SPM with Z and R1:R0 as they are; the answer is how many cycles the CPU is halted.
    std::function<void(std::uint32_t address, std::uint16_t word)> spm;
    /// LPM or ELPM of this byte address; true and a value if not the flash answers (fuses, lock bits, a busy
    /// section).
    std::function<bool(std::uint32_t address, std::uint8_t& value)> load_program;
};

}  // namespace puckloop::avr
