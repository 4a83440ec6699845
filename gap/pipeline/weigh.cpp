#include "gap/pipeline/weigh.h"

#include "gap/decide/no_mechanism.h"
#include "gap/decide/roles.h"
#include "gap/diagnostics/heldout.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit_test/wander.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap {

namespace {

double cost_at(const Study& study, const State& state) {
    return cost_of(study.model(), state, study.model().predicted(state.values));
}

/// What one chance of each kind of event takes off the cost of the simulator as it is.
double lowered_by_rates(const Study& study, const State& none) {
    const auto costs = costs_at(study.model(), none, study.model().predicted(none.values));
    double lowered = 0.0;
    for (std::size_t o = 0; o < costs.size(); ++o) {
        const auto& rows = costs[o].cost;
        lowered +=
            lowered_by_rate(study.model().observables()[o], std::accumulate(rows.begin(), rows.end(), 0.0));
    }
    return lowered;
}

/// Does a parameter make much of what is gained, of events beyond one chance for all? Of an effect with
/// several, one may stop at its end beside the one that explains. With it back at neutral and nothing else
/// fitted again, this errs towards yes.
bool carries(const Study& study, const Chosen& chosen, const Freed& freed) {
    const auto index = freed.index;
    State without = chosen.final.fitted.state;
    without.values[index] = study.model().parameters()[index].neutral;
    const State& begun = chosen.selection.none.fitted.state;
    const double best = cost_at(study, chosen.final.fitted.state),
                 none = cost_at(study, begun) - lowered_by_rates(study, begun);
    return cost_at(study, without) - best > thresholds::kShareLeft * (none - best);
}

bool stopped_at_end(const Study& study, const Chosen& chosen) {
    const auto& freed = chosen.final.freed;
    return std::ranges::any_of(freed, [&](const Freed& one) {
        return !std::isnan(end_of_range(study, chosen.final, one)) && carries(study, chosen, one);
    });
}

bool all_in_rounding(const Study& study, const Fit& chosen) {
    return !chosen.effects.empty() && std::ranges::all_of(chosen.effects, [&](std::size_t one) {
        return within_rounding(study, chosen, one);
    });
}

/// With fewer than three runs stretches of the same run are held out: a drift of that run predicts itself.
/// Then the error has to fall for sure, not only the score to rise.
bool few_runs_disagree(const Study& study, const Selection& selection, std::uint64_t seed) {
    return study.experiment().runs.size() < thresholds::kRunsThatJudge &&
           held_figures(study, selection, seed).all.high >= 1.0;
}

bool any_adds_up(const Study& study) {
    const auto& all = study.model().observables();
    return std::ranges::any_of(all, adds_up);
}

/// What functions of covariates gain of what does not add up, or the surest structure there may stand for.
double left_of_readings(const Study& study, const Diagnosis& diagnosis) {
    return left_of(diagnosis.free_forms, diagnosis.structures, [&](const std::string& name) {
        return std::ranges::any_of(study.model().observables(),
                                   [&](const Observable& one) { return one.name == name && !adds_up(one); });
    });
}

/// Notes what is left for sure.
void take_structure(const Diagnosis& diagnosis, Grounds& g) {
    const auto clear = [](const FreeForm& form) { return form.clear; };
    const auto other = [&](const Leftover& one) { return is_sure(one) && one.covariate != kWanderCovariate; };
    const auto& left = diagnosis.leftovers;
    const bool shaped = std::ranges::any_of(diagnosis.free_forms, clear) || std::ranges::any_of(left, other);
    g.structure = shaped || std::ranges::any_of(left, is_sure);
    g.only_wanders = g.structure && !shaped;
}

}  // namespace

double range_end(double value, double low, double high, double neutral) {
    const bool wide = low > 0 && high / low > thresholds::kWideRange;
    const auto scaled = [wide](double one) { return wide ? std::log(one) : one; };
    const double near = thresholds::kRangeEnd * (scaled(high) - scaled(low));
    for (const double end : {low, high}) {
        // Nothing, and all of a share, are ends of what there is, not of what is believed.
        if (end == 0.0 || (end == 1.0 && low == 0.0)) continue;
        const bool beside_neutral = (!wide || neutral > 0) && std::abs(scaled(end) - scaled(neutral)) <= near;
        if (!beside_neutral && !(wide && value <= 0) && std::abs(scaled(value) - scaled(end)) < near)
            return end;
    }
    return std::numeric_limits<double>::quiet_NaN();
}

double end_of_range(const Study& study, const Fit& fit, const Freed& freed) {
    const auto index = freed.index;
    return range_end(fit.fitted.state.values[index], freed.low, freed.high,
                     study.model().parameters()[index].neutral);
}

double share_allowed(const Study& study) {
    return any_adds_up(study) ? thresholds::kShareLeftOfSums : thresholds::kShareLeft;
}

Grounds grounds_of(const Study& study, const Chosen& chosen, const Diagnosis& diagnosis, std::uint64_t seed) {
    const Selection& selection = chosen.selection;
    Grounds g;
    g.causes = selection.steps.size();
    for (const Candidate& candidate : study.candidates())
        g.candidates += candidate.remark.empty() ? 1 : 0;
    g.gain = study.gain(selection.held_none, selection.held_chosen);
    g.assumed = fmt::format("{}", fmt::join(study.experiment().assumed, ", "));
    g.stopped_at_end = stopped_at_end(study, chosen);
    g.in_rounding = all_in_rounding(study, selection.chosen);
    g.error_falls = g.causes == 0 || !few_runs_disagree(study, selection, seed);
    g.left_by_shape = gained_by_shape(diagnosis.free_forms);
    for (const auto& [effect, form] : diagnosis.forms)
        g.left_by_form = std::max(g.left_by_form, form.left);
    g.left_by_run = diagnosis.left_by_run;
    g.left_by_structure = most_by_structure(diagnosis.structures);
    g.sums = any_adds_up(study);
    g.left_of_readings = left_of_readings(study, diagnosis);
    take_structure(diagnosis, g);
    return g;
}

}  // namespace puckloop::gap
