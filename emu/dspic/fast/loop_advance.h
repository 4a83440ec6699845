#pragma once
// From anywhere in a waiting loop to the first boundary at or after the limit, in one step.
//
// A loop that changes nothing, or only counts, goes on in the same way from every boundary between two of its
// instructions, as long as the machine's state there is the one that its trace (idle_loops.h) predicts: W
// registers, flags, the RAM words that the loop reads, the registers that it polls. So where it is at a later
// cycle follows by a division. Events and interrupts come in between as always, at their exact boundaries;
// after a routine the state is compared anew.

#include "emu/dspic/fast/idle_loops.h"
#include "emu/dspic/machine/machine.h"

namespace puckloop::dspic {

/// A plan that holds was met at its branch: from the loop's head on advance_in_loop() may do. False if the
/// loop is not of this kind, or something else does better.
bool enter_loop(Machine& m, IdleLoops::Branch& known);
/// The same for a loop in which the machine was when it last advanced, and whose branch was now executed.
bool back_in_loop(Machine& m, IdleLoops::Branch& known);
/// Inside a waiting loop: goes on towards Machine::limit, exactly as executing would. False, and nothing
/// done, if the machine is not where Machine::skip expects it.
bool advance_in_loop(Machine& m);

}  // namespace puckloop::dspic
