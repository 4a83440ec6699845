#pragma once
// Busy-wait loops, skipped forward without changing anything observable.
//
// At a short backward branch that is taken, one iteration is walked through symbolically from the machine's
// present state: every W register and RAM word is a value that changes by a constant step an iteration, or
// not at all. The walk knows a subset of the instructions and follows calls and inner branches; whatever it
// does not know, every write to a register, and every read of a register with side effects ends it. It yields
//   - the iteration's length in cycles and instructions, stalls included,
//   - the step of every cell that an iteration reads before it writes it,
//   - how many iterations take the same path: no addition wraps, no sign and no zero changes on the way.
//   - the registers that it polls, and their values.
// The next real iteration must end in the state that the walk predicted; only then are iterations skipped,
// at most up to the next event, and one fewer than could be, so that a real one sets flags and scratch cells.
// A loop that changes nothing at all from iteration to iteration (it waits for somebody else) is skipped
// together with the interrupts that leave no trace (isr_summary.h): see fast_forward.h. Other interrupts come
// in where they do: loop_advance.h goes from one to the next.
//
// A plan stays good over events and interrupts for as long as its cells and registers are as predicted at
// every arrival at the branch.

#include "emu/dspic/fast/fast_work.h"
#include "emu/dspic/fast/loop_table.h"
#include "emu/dspic/walk/loop_plan.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <vector>

namespace puckloop::dspic {

struct Machine;
struct Op;

struct IdleLoops {
    using Cell = LoopPlan::Cell;
    using Plan = LoopPlan;
    /// What is known of one backward branch.
    struct Branch {
        std::uint16_t place = 0;    ///< in `branches` and `waits`
        std::uint8_t patience = 0;  ///< failures in a row
        bool polls_noted = false;   ///< note_polls() was called for it
        bool walked = false;        ///< a walk came round once: no way out of the loop decides for all of it
        Plan plan;
        LoopTrace trace;
        LoopTable table;          ///< of the trace, once it is wanted
        std::uint32_t noted = 0;  ///< by the LoopUndo with this stamp ...
        std::size_t note = 0;     ///< ... at this place
    };
    std::vector<std::uint16_t> index;  ///< by program word: place in `branches` plus 1, 0 = not seen yet
    std::deque<Branch> branches;
    std::vector<std::uint16_t> waits;  ///< by branch: arrivals until the next try
    LoopPosition position;
    FastWork work;
    std::uint64_t skips = 0;  ///< for tests and curiosity
    std::uint64_t skipped_cycles = 0;
    std::uint64_t passed_services = 0;  ///< routines without a trace that fell into skips
};

/// Sets Machine::loop_index and loop_waits.
void publish_loops(Machine& m);
/// Makes the table of the branch's plan and trace; these stay as they are as long as it is used.
void make_table(Machine& m, IdleLoops::Branch& known);

}  // namespace puckloop::dspic
