#pragma once
// What a chip went through, as JSON: the part that the bench and the run's report share.

#include "emu/dspic/chip/chip.h"

#include <nlohmann/json_fwd.hpp>

namespace puckloop::board {

/// cycles, instructions, resets and traps (time_s, cause or name, pc, symbol), unmodelled (name, address, pc, access,
/// time_s), waiting (since_s, hung, loop, text) while the program does, refused_addresses (module, address,
/// times), warnings (chip_warnings.h).
nlohmann::ordered_json chip_json(const dspic::Chip& chip);
/// sent, received, framing_errors, parity_errors, overruns.
nlohmann::ordered_json uart_json(const dspic::UartCounters& counters);

}  // namespace puckloop::board
