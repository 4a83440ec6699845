#include "campaigns/experiment/progress.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::swarm {

std::string duration_text(double seconds) {
    constexpr double kMinute = 60.0, kHour = 3600.0;
    if (seconds < 2 * kMinute) return fmt::format("{:.0f} s", seconds);
    if (seconds < 2 * kHour) return fmt::format("{:.0f} min", seconds / kMinute);
    return fmt::format("{:.1f} h", seconds / kHour);
}

Progress::Progress(const Experiment& experiment, const std::vector<Run>& runs,
                   const std::map<int, RunResult>& done, int side_by_side)
    : experiment_(experiment), side_by_side_(std::max(1, side_by_side)) {
    for (const Run& run : runs)
        runs_[run.id] = run;
    for (const auto& [id, result] : done) {
        ++done_;
        wall_ += result.wall;
    }
}

double Progress::left() const {
    if (done_ == 0) return -1.0;
    const std::size_t left = runs_.size() - std::min(done_, runs_.size());
    const auto wide = std::min(static_cast<std::size_t>(side_by_side_), std::max<std::size_t>(left, 1));
    return wall_ / static_cast<double>(done_) * static_cast<double>(left) / static_cast<double>(wide);
}

std::string Progress::beginning() const {
    const std::size_t left = runs_.size() - std::min(done_, runs_.size());
    std::string text = fmt::format("{} run{}: {} program{}, {} condition{}, {} seed{}", runs_.size(),
                                   runs_.size() == 1 ? "" : "s", experiment_.programs.size(),
                                   experiment_.programs.size() == 1 ? "" : "s", experiment_.conditions.size(),
                                   experiment_.conditions.size() == 1 ? "" : "s", experiment_.seeds.size(),
                                   experiment_.seeds.size() == 1 ? "" : "s");
    text += fmt::format("; {} run now, {} at a time", left,
                        std::min<std::size_t>(left, static_cast<std::size_t>(side_by_side_)));
    if (done_ > 0 && left > 0) text += fmt::format(", about {}", duration_text(this->left()));
    return text + "\n";
}

std::string Progress::take(int id, const RunResult& result) {
    const auto found = runs_.find(id);
    if (found == runs_.end()) return {};
    ++done_;
    wall_ += result.wall;
    const Run& run = found->second;
    std::string text = fmt::format("run {} of {}: {}, {}, seed {}: {} ({:.1f} s)", done_, runs_.size(),
                                   experiment_.programs[run.program].name,
                                   experiment_.conditions[run.condition].name, run.seed,
                                   result.score            ? fmt::format("score {:.6g}", *result.score)
                                   : result.failed.empty() ? std::string("no score")
                                                           : "failed: " + result.failed,
                                   result.wall);
    if (done_ < runs_.size()) text += fmt::format("; about {} left", duration_text(left()));
    return text + "\n";
}

}  // namespace puckloop::swarm
