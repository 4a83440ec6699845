#pragma once
// Skipping iterations of a loop that changes nothing, together with interrupts that leave no trace.
//
// Such a loop's state at its branch is the same at every arrival; only time passes, and dead words above the
// stack pointer change. Events of one slot may fall into the skip if all they do is to raise an interrupt
// whose routine has a summary: where each comes in follows from the times at which the loop's instructions
// start, and what it costs from the summary. The skip ends at an arrival before any other event.

#include "emu/dspic/fast/idle_loops.h"

namespace puckloop::dspic {

struct Machine;

/// The next event is one that such a skip may pass.
bool steady_event_next(Machine& m);
/// Arrival at the branch after `iterations` more; kNoCycle if something else than routines without a trace
/// may come between, or if the loop is not of this kind. `interrupted`: whether any routine does.
std::uint64_t fast_forward_arrival(Machine& m, IdleLoops::Branch& known, std::uint64_t arrival,
                                   std::uint64_t iterations, bool& interrupted);
/// Skips; false if nothing was to be gained. The machine stands at the branch, arrival being when it is over.
bool fast_forward(Machine& m, IdleLoops::Branch& known, std::uint64_t arrival);

}  // namespace puckloop::dspic
