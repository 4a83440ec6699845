#include "gap/identify/known.h"

#include "gap/evidence/thresholds.h"
#include "gap/findings/quantities.h"
#include "gap/fit/intervals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kEnd = 0.01;  // of a range: its upper end

double cost_with(const Study& study, const State& state) {
    return cost_of(study.model(), state, study.model().predicted(state.values));
}

/// Does this number make much of what its effect gains?
bool makes_much(const Study& study, const Fit& fit, std::size_t effect, std::size_t index) {
    const State& all = fit.fitted.state;
    State without = all;
    without.values[index] = study.model().parameters()[index].neutral;
    const double best = cost_with(study, all), none = cost_with(study, study.without(effect, all));
    return cost_with(study, without) - best > thresholds::kShareLeft * (none - best);
}

std::string why_unknown(const Study& study, const Fit& fit, const Precision& precision, std::size_t j) {
    const Freed& freed = fit.freed[j];
    const ModelParameter& parameter = study.model().parameters()[freed.index];
    const double value = fit.fitted.state.values[freed.index], neutral = parameter.neutral;
    if (freed.possible > 1 && neutral > 0 &&
        (value > neutral * freed.possible || value < neutral / freed.possible))
        return fmt::format("{} of {} is not possible where the experiment states {} (state another robot's "
                           "in [nominal]): not identifiable by these drives",
                           parameter.name, quantity(value, parameter.unit),
                           quantity(neutral, parameter.unit));
    if (precision.sd[j] <= thresholds::kNarrower * freed.prior_sd) return "";
    // At the end of its range, as a loss of all messages is, there is no curve to judge by.
    if (value >= freed.high - kEnd * (freed.high - freed.low)) return "";
    return fmt::format("{} is known to +- {} only, no better than it was believed before (+- {}): not "
                       "identifiable by these data",
                       parameter.name, quantity(precision.sd[j], parameter.unit),
                       quantity(freed.prior_sd, parameter.unit));
}

}  // namespace

NotIdentified not_known(const Study& study, const Fit& fit) {
    NotIdentified result;
    const Precision precision = precision_of(study, fit);
    for (const std::size_t effect : fit.effects) {
        const Candidate& candidate = study.candidates()[effect];
        if (candidate.effect->role != EffectRole::Mean) continue;
        for (const Freed& freed : candidate.freed) {
            if (freed.threshold || !makes_much(study, fit, effect, freed.index)) continue;
            const auto j = std::ranges::find(fit.freed, freed.index, &Freed::index) - fit.freed.begin();
            std::string why = why_unknown(study, fit, precision, static_cast<std::size_t>(j));
            if (why.empty()) continue;
            result.effects.push_back(effect);
            result.why += (result.why.empty() ? "" : "; ") + why;
            break;
        }
    }
    return result;
}

}  // namespace puckloop::gap
