#pragma once
// A record of a report, with the place in the program it is about.

#include "base/json.h"
#include "emu/image/code_places.h"

#include <cstdint>
#include <string>

namespace puckloop::board {

/// `record` with "symbol" and "line" of `pc`, where the image has them.
inline nlohmann::ordered_json with_place(nlohmann::ordered_json record, const image::CodePlaces& places,
                                         std::uint32_t pc) {
    if (const std::string symbol = places.symbol(pc); !symbol.empty()) record["symbol"] = symbol;
    if (const std::string line = places.line(pc); !line.empty()) record["line"] = line;
    return record;
}

}  // namespace puckloop::board
