#pragma once
// What faults a client may add: kinds with their parameters, and what of the run they can sit on. For forms.

#include "scenarios/description/scenario.h"

#include <nlohmann/json_fwd.hpp>

namespace puckloop::tools {

/// "kinds": name, "on" (what they sit on), "style" ("each", "hold" or "times"), "parameters" (key, unit,
/// range, fallback, choices, whether required). "places": name, "on", "key" ("link" or "node"), "ends".
nlohmann::ordered_json possible_faults(const scenarios::Scenario& scenario);

}  // namespace puckloop::tools
