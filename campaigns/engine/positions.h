#pragma once
// Where in the nominal run's traffic a fault goes.

#include "campaigns/engine/plan.h"

#include <string>
#include <vector>

namespace puckloop::faults {

struct Position {
    std::string name;     ///< "byte 12", "record 3 sensors light[2] low (byte 44)"
    std::string begin;    ///< the byte's start bit in the nominal run, "3.512345 s", at most 1 us before
    std::string missing;  ///< why there is none; empty: there is one
};

/// The sweep's bytes and records of what `from` sends on `link`, both keys of the fault.
std::vector<Position> positions_of(const Sweep& sweep, const nlohmann::json& fault, const Profile& nominal);

/// Frames of a sender as records, bytes without a pause of more than two byte times: index of the first byte
/// of each, and the number of frames at the end.
std::vector<std::size_t> records_of(const Sender& sender);

}  // namespace puckloop::faults
