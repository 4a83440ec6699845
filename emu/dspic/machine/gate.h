#pragma once
// A run that ends where the program would look at what is not known yet.

#include "emu/dspic/machine/event_queue.h"
#include "emu/dspic/machine/sfr_space.h"

#include <bitset>

namespace puckloop::dspic {

struct Machine;
struct Op;

/// Registers, by word.
using RegisterSet = std::bitset<SfrSpace::kWords>;

/// From cycle `from` on no instruction is begun that may access one of the registers, and no reset: the run
/// ends before it.
struct Gate {
    Cycle from = kNoCycle;
    const RegisterSet* registers = nullptr;
    bool held = false;  ///< the last run ended so
};

/// The instruction may access one of the gate's registers. True as well where that is not sure: where a run
/// is cut makes no difference to what is executed.
bool may_access(const Machine& m, const Op* op);

}  // namespace puckloop::dspic
