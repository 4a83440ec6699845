#include "gap/diagnostics/agenda.h"

#include "gap/fit/parallel.h"
#include "gap/fit/study.h"
#include "gap/fit/thinned.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <array>

namespace puckloop::gap {

namespace {

constexpr double kBeyondDoubt = 50.0;  // nats
constexpr std::size_t kRows = 3000;    // that are looked at
constexpr const char* kAgenda = "firmware.agenda";
// What a robot of other wheels does as well.
constexpr const char* kWheels[] = {"wheel_scale", "wheel_mismatch", "axle_length"};

/// ln likelihood of the drives with all of `effects` that apply to them.
double likelihood_of(const Experiment& experiment, const std::vector<std::string>& effects,
                     std::uint64_t seed) {
    const Study study(experiment, seed);
    Fit best = study.fit_none();
    std::vector<std::size_t> set;
    for (const std::string& name : effects)
        for (std::size_t i = 0; i < study.candidates().size(); ++i) {
            const Candidate& one = study.candidates()[i];
            if (one.effect->name != name || !one.remark.empty()) continue;
            set.push_back(i);
            best = study.fit_set(set, best.fitted.state);
        }
    return best.fitted.log_likelihood;
}

}  // namespace

std::string agenda_caution(const Experiment& experiment, const std::vector<std::string>& effects,
                           std::uint64_t seed, unsigned threads) {
    if (experiment.kind != Kind::Motion || !experiment.has("cmd_left") || experiment.has("steps_left"))
        return "";
    const bool staircase = experiment.nominal_or(kAgenda, 1.0) != 0;
    std::vector<std::string> all(std::begin(kWheels), std::end(kWheels));
    for (const std::string& name : effects)
        if (!stats::contains(all, name)) all.push_back(name);
    std::array<Experiment, 2> parts{thinned(experiment, kRows), thinned(experiment, kRows)};
    parts[1].nominal[kAgenda] = staircase ? 0.0 : 1.0;
    std::array<double, 2> likelihood{};
    in_parallel(parts.size(), threads,
                [&](std::size_t k) { likelihood[k] = likelihood_of(parts[k], all, seed); });
    const double better = likelihood[1] - likelihood[0];
    if (!(better > kBeyondDoubt)) return "";
    return fmt::format(
        "{} (by {:.0f} nats, whatever its wheels are): set \"firmware.agenda\" = {} in [nominal]",
        staircase ? "the robot keeps to its commands better than to the staircase of speeds that the "
                    "original firmware's agenda makes of them"
                  : "the robot keeps to the staircase of speeds that the original firmware's agenda "
                    "makes of its commands better than to the commands themselves",
        better, staircase ? 0 : 1);
}

}  // namespace puckloop::gap
