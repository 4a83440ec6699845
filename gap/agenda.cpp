#include "gap/agenda.h"

#include "gap/fit/study.h"
#include "gap/fit/thinned.h"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

namespace puckloop::gap {

namespace {

constexpr double kBeyondDoubt = 30.0;  // nats
constexpr std::size_t kRows = 3000;    // that are looked at
constexpr const char* kAgenda = "firmware.agenda";
// What a robot of other wheels does as well.
constexpr std::string_view kWheels[] = {"wheel_scale", "wheel_mismatch", "axle_length"};

/// ln likelihood of the drives with the wheels fitted.
double likelihood_of(const Experiment& experiment, std::uint64_t seed, unsigned threads) {
    const Study study(experiment, seed, threads);
    Fit best = study.fit_none();
    std::vector<std::size_t> wheels;
    for (std::size_t i = 0; i < study.candidates().size(); ++i) {
        const Candidate& one = study.candidates()[i];
        const bool wanted =
            std::find(std::begin(kWheels), std::end(kWheels), one.effect->name) != std::end(kWheels);
        if (wanted && one.remark.empty()) wheels.push_back(i);
    }
    if (!wheels.empty()) best = study.fit_set(wheels, best.fitted.state);
    return best.fitted.log_likelihood;
}

}  // namespace

std::string agenda_caution(const Experiment& experiment, std::uint64_t seed, unsigned threads) {
    if (experiment.kind != Kind::Motion || !experiment.has("cmd_left") || experiment.has("steps_left"))
        return "";
    const auto told = experiment.nominal.find(kAgenda);
    const bool staircase = told == experiment.nominal.end() || told->second != 0;
    Experiment part = thinned(experiment, kRows);
    const double here = likelihood_of(part, seed, threads);
    part.nominal[kAgenda] = staircase ? 0.0 : 1.0;
    const double better = likelihood_of(part, seed, threads) - here;
    if (!(better > kBeyondDoubt)) return "";
    return fmt::format(
        "{} (by {:.0f} nats, whatever its wheels and axle): see \"firmware.agenda\" = {} in [nominal]",
        staircase ? "the robot keeps to its commands better than to the staircase of speeds that the "
                    "original firmware's agenda makes of them"
                  : "the robot keeps to the staircase of speeds that the original firmware's agenda "
                    "makes of its commands better than to the commands themselves",
        better, staircase ? 0 : 1);
}

}  // namespace puckloop::gap
