#pragma once
// Interrupt service routines that leave no trace, taken in one step.
//
// A routine that only saves and restores registers, writes registers of modules the values that they hold
// already, and clears its own flag, changes nothing but time and the dead words above the stack pointer. Such
// a routine is walked through once: its pushes, its cycles and its conditions make a summary. At an
// interrupt that leads to it the summary is taken if the conditions hold and nothing else can happen before
// its end; else the routine is executed. (A firmware that refreshes a duty cycle at every period of its
// carrier spends a third of its instructions in such a routine.)

#include "emu/dspic/machine/event_queue.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::dspic {

struct Machine;
struct Op;

struct IsrSummary {
    enum class Word : std::uint8_t { Register, Constant, StackOffset, ReturnLow, ReturnHigh };
    /// A word that ends up above the interrupted stack pointer.
    struct Push {
        std::uint16_t offset = 0;  ///< from the stack pointer
        Word kind{};
        std::uint16_t value = 0;  ///< number of the register, the constant, or the offset
    };
    /// A module's register that is written the value it is expected to hold.
    struct Refresh {
        std::uint16_t address = 0;
        std::uint16_t value = 0;
    };
    static constexpr std::size_t kMost = 12;

    std::uint32_t handler = 0;  ///< program address it was made for
    bool possible = false;
    std::array<Push, kMost> pushes{};
    std::size_t push_count = 0;
    std::array<Refresh, kMost> refreshes{};
    std::size_t refresh_count = 0;
    std::uint16_t depth = 0;   ///< bytes of stack in use at most
    std::uint32_t uses = 0;    ///< pointers that must have been set (upper half of Op::uses)
    std::uint32_t keep = 0;    ///< what stays of Machine::watch
    std::uint32_t writes = 0;  ///< the last instruction's, for a stall behind it
    std::uint64_t cycles = 0;  ///< from the first instruction's start to the end of RETFIE
    std::uint64_t instructions = 0;
};

/// What a routine interrupts: registers, status and the address to come back to.
struct Interrupted {
    const std::uint16_t* w = nullptr;
    std::uint16_t sr = 0;
    std::uint32_t pc = 0;
};

/// The summary for an interrupt vector, if its routine has one.
const IsrSummary* isr_summary(Machine& m, int vector);
/// True if what it expects of the modules' registers is so now.
bool refreshes_hold(const Machine& m, const IsrSummary& summary);
/// True if `depth` bytes find room with the stack pointer at `stack`.
bool stack_holds(const Machine& m, std::uint16_t depth, std::uint16_t stack);
/// Does what the routine leaves behind.
void push_trace(Machine& m, const IsrSummary& summary, const Interrupted& interrupted);

}  // namespace puckloop::dspic
