#pragma once
// Whose state a state is: from a board's node description.

#include "cosim/resume/board_state.h"

#include <nlohmann/json_fwd.hpp>

namespace puckloop::tools {

/// Of a "pic", "rab" or "tam" description. Reads the firmware's file for its hash; throws InputError.
cosim::BoardIdentity identity_of(const nlohmann::json& spec);

/// True if the description is of a board whose state can be saved.
bool has_state(const nlohmann::json& spec);

}  // namespace puckloop::tools
