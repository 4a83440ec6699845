#pragma once
// A TAM's part of the run's report.

#include "emu/tam_avr/tam_log.h"

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <vector>

namespace puckloop::tam {

/// `start` is when the board was switched on: its own time counts from there. `warnings` of the image come
/// before those of the chip.
nlohmann::ordered_json tam_json(const Board& board, const TamLog& log,
                                const std::vector<std::string>& warnings, cosim::Time start);

}  // namespace puckloop::tam
