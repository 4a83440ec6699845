#pragma once
// What a run scored.

#include "missions/mission.h"

#include <filesystem>
#include <limits>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace puckloop::tools {

/// By the robots' places in trajectory.csv at the end of each step: kind, score, better ("more" or "less"),
/// steps and their length. The score is null where a run has no step, where it is not finite, and, with
/// `why`, where the file cannot be read. `until` in s: what programs do in the time that they have to end
/// does not count.
nlohmann::ordered_json mission_score(const missions::Mission& mission,
                                     const std::filesystem::path& trajectory,
                                     double until = std::numeric_limits<double>::infinity());

/// Such a score as a line for the terminal.
std::string mission_summary(const nlohmann::ordered_json& score);

}  // namespace puckloop::tools
