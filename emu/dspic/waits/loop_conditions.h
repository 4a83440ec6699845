#pragma once
// What a busy-wait loop waits for. The loop is walked symbolically (symbolic_loop.h) from where the program
// is, then once more for each bit of each word that it reads, with that bit inverted: bits with which the
// walk takes another way, or does not come round, are its conditions.

#include "emu/dspic/waits/wait_watch.h"

#include <optional>

namespace puckloop::dspic {

/// To be called at a taken branch. Nothing if the walk does not know the loop.
std::optional<LoopFinding> find_conditions(const Machine& m, const Op* branch, const Op* head);

}  // namespace puckloop::dspic
