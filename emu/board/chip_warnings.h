#pragma once
// What somebody who looks at a robot would want to be warned of: a program that hangs, registers without a
// model, addresses where nobody answers. The same lines for the bench and for a run.

#include "emu/dspic/chip/chip.h"

#include <optional>
#include <string>
#include <vector>

namespace puckloop::board {

/// "has run 12.0 s in the loop 0xba68..0xba6e reading RCON, bit BGST, which no model drives"; nothing for a
/// chip whose program does not wait in one loop.
std::optional<std::string> waiting_text(const dspic::Chip& chip,
                                        const std::optional<dspic::WaitReport>& wait);

/// One line each, the hang first; empty for a robot in order.
std::vector<std::string> chip_warnings(const dspic::Chip& chip);

}  // namespace puckloop::board
