#pragma once
// What a range-and-bearing board went through, as JSON: the part that the bench and the run's report share.

#include "emu/rab_board/rab_log.h"

#include <nlohmann/json_fwd.hpp>

namespace puckloop::rab {

/// `emission` (frames, irregular, carrier_hz, power) and `i2c` (counters, seconds).
nlohmann::ordered_json activity_json(const Board& board, const RabLog& log);
/// All of a node's report.
nlohmann::ordered_json rab_json(const dspic::Chip& chip, const Board& board, const RabLog& log);

}  // namespace puckloop::rab
