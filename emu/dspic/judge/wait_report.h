#pragma once
// What a chip reports of its program's waiting, for reports.

#include "emu/dspic/machine/event_queue.h"

#include <cstdint>
#include <string>

namespace puckloop::dspic {

/// The program is in a loop (or asleep) and has been since `since`.
struct WaitReport {
    Cycle since = 0;
    std::uint32_t first = 0, last = 0;  ///< the loop's head and branch, program addresses
    bool asleep = false;                ///< Sleep or Idle instead of a loop
    bool hung = false;                  ///< it cannot end by itself
    /// What follows "has run 12 s in the loop 0xba68..0xba6e ": "reading RCON, bit BGST, which no model
    /// drives".
    std::string text;
};

/// A loop, left or not, that waited for bits which silicon changes and no model does.
struct MissingBitReport {
    Cycle cycle = 0;
    std::uint32_t first = 0, last = 0;
    std::string bits;  ///< "RCON, bit BGST"
};

}  // namespace puckloop::dspic
