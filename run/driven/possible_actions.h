#pragma once
// What a client may do to the world, and to what of it. For forms; the words are those of `act`.

#include "scenarios/description/scenario.h"

#include <nlohmann/json_fwd.hpp>

namespace puckloop::tools {

/// "actions": verb, "usage", "help", "keys" (their names). "things": what `add` can add, "kind" and "keys".
/// "objects": what there is at the beginning, "name" and "kind". "parameters": those that `tune` can change,
/// "name", "unit", "range", "fallback" (the default).
nlohmann::ordered_json possible_actions(const scenarios::Scenario& scenario);

}  // namespace puckloop::tools
