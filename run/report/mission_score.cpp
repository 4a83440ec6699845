#include "run/report/mission_score.h"

#include "base/error.h"
#include "base/json.h"
#include "missions/scorer.h"
#include "physics/render/path_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace puckloop::tools {

nlohmann::ordered_json mission_score(const missions::Mission& mission,
                                     const std::filesystem::path& trajectory, double until) {
    nlohmann::ordered_json result{{"kind", mission.name},
                                  {"score", nullptr},
                                  {"better", missions::more_is_better(mission.kind) ? "more" : "less"},
                                  {"steps", 0},
                                  {"step_s", mission.step}};
    physics::Paths paths;
    try {
        paths = physics::read_paths(trajectory);
    } catch (const RunError& error) {  // a run that did not begin has none
        result["why"] = error.what();
        return result;
    }
    missions::Scorer scorer(mission);
    std::size_t rows = paths.empty() ? 0 : std::numeric_limits<std::size_t>::max();
    for (const auto& [robot, path] : paths)
        rows = std::min(rows, path.size());
    std::vector<missions::Place> places(paths.size());
    std::int64_t last = 0;
    for (std::size_t row = 0; row < rows; ++row) {
        // Whole steps since the beginning; rows between them are ignored.
        const double steps = (paths[0].second[row].seconds - mission.begin) / mission.step;
        const std::int64_t step = std::llround(steps);
        if (paths[0].second[row].seconds > until + mission.step / 2) break;
        if (step <= last || std::abs(steps - static_cast<double>(step)) > 1e-3) continue;
        last = step;
        for (std::size_t i = 0; i < paths.size(); ++i)
            places[i] = {paths[i].second[row].x, paths[i].second[row].y};
        scorer.step(places);
    }
    result["steps"] = scorer.steps();
    if (scorer.steps() > 0 && std::isfinite(scorer.score())) result["score"] = scorer.score();
    return result;
}

std::string mission_summary(const nlohmann::ordered_json& score) {
    const auto kind = score.at("kind").get<std::string>();
    const auto steps = score.at("steps").get<std::uint64_t>();
    const std::string why = score.value("why", "");
    if (score.at("score").is_null())
        return fmt::format("mission {}: no score: {}", kind,
                           !why.empty() ? why
                           : steps == 0 ? "no step was counted"
                                        : "no robot counts");
    const std::string length =
        score.contains("step_s") ? fmt::format("{} steps of {:g} s", steps, score.at("step_s").get<double>())
                                 : fmt::format("{} frames of the tracker", steps);
    return fmt::format("mission {}: score {:.6g} ({} is better), {}{}", kind, score.at("score").get<double>(),
                       score.at("better").get<std::string>(), length, why.empty() ? "" : "; " + why);
}

}  // namespace puckloop::tools
