#pragma once
// What a run scored.

#include "missions/mission.h"

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

namespace puckloop::tools {

/// By the robots' places in trajectory.csv at the end of each step: kind, score, better ("more" or "less"),
/// steps. The score is null where a run has no step, where it is not finite, and, with `why`, where the file
/// cannot be read.
nlohmann::ordered_json mission_score(const missions::Mission& mission,
                                     const std::filesystem::path& trajectory);

/// The same as a line for the terminal.
std::string mission_summary(const missions::Mission& mission, const std::filesystem::path& trajectory);

}  // namespace puckloop::tools
