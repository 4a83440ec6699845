#pragma once
// CAN buses of a run: a node for each [[can_bus]] table, a link to each of its controllers.

#include "run/plan/setup.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace puckloop::tools {

/// "can" of a board's description: its modules that a bus is wired to, by bit.
void add_can_modules(const scenarios::Scenario& scenario, const std::string& board, nlohmann::json& spec);
void add_can_buses(RunSetup& setup);

}  // namespace puckloop::tools
