#include "gap/pipeline/diagnose.h"

#include "gap/diagnostics/leftovers.h"
#include "gap/diagnostics/series.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit_test/run_differences.h"
#include "gap/fit_test/wander.h"
#include "gap/predictive/check.h"
#include "gap/predictive/discrepancies.h"
#include "gap/residual_model/free_form.h"
#include "gap/validate/placements.h"
#include "gap/verdict/sentences.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>

namespace puckloop::gap {

namespace {

/// Offsets of placements say more than that rows carry over.
void name_placements(const Experiment& experiment, Diagnosis& found) {
    for (const Series& series : found.series) {
        const std::string shape = placement_shape(experiment, series);
        if (shape.empty()) continue;
        const auto serial = std::ranges::find_if(found.leftovers, [&](const Leftover& one) {
            return one.observable == series.observable && one.covariate == "previous sample";
        });
        if (serial == found.leftovers.end()) continue;
        serial->covariate = kPlacementCovariate;
        serial->shape = shape;
    }
}

/// Where a curve is farthest from its replicates, and by how much it lies outside, in its unit.
std::pair<std::size_t, double> farthest_of(const PredictiveCurve& curve) {
    std::size_t place = 0;
    double most = -1.0, outside = 0.0;
    for (std::size_t k = 0; k < curve.x.size(); ++k) {
        const double width = curve.high[k] - curve.low[k],
                     off = std::max(curve.measured[k] - curve.high[k], curve.low[k] - curve.measured[k]);
        if (!(off > most * width)) continue;
        most = width > 0 ? off / width : off;
        outside = off;
        place = k;
    }
    return {place, outside};
}

/// "run 8 has 0.91 rad where the fit makes 0.04 to 0.3"
std::string farthest_place(const PredictiveCurve& curve, const std::string& unit) {
    const std::size_t place = farthest_of(curve).first;
    const std::string where =
        curve.categories.empty() ? fmt::format("{:.3g}", curve.x[place]) : curve.categories[place];
    const double largest =
        std::max({std::abs(curve.measured[place]), std::abs(curve.low[place]), std::abs(curve.high[place])});
    const auto shown = [&](double value) {
        return quantity(value, unit == "1" ? kShare : unit, -1, largest);
    };
    return fmt::format("{} at {} {}, where the fit makes {} to {}", shown(curve.measured[place]),
                       curve.x_label, where, shown(curve.low[place]), shown(curve.high[place]));
}

/// Curves of residuals that the fitted model does not make (posterior-predictive), p by Bonferroni.
std::vector<Leftover> not_replicated(const Study& study, const State& state,
                                     const std::vector<PredictiveCheck>& checks) {
    const auto& observables = study.model().observables();
    const auto is_step = [&](const PredictiveCheck& check, const PredictiveCurve& curve) {
        for (std::size_t o = 0; o < observables.size(); ++o)
            if (observables[o].name == check.observable)
                return is_within_step(observables[o], state.noise[o]) &&
                       farthest_of(curve).second < observables[o].instrument.quantum;
        return false;
    };
    std::vector<Leftover> all;
    double looks = 0.0;
    for (const PredictiveCheck& check : checks)
        for (const PredictiveCurve& curve : check.curves) {
            if (!curve.counts) continue;
            looks += 1;
            if (!is_step(check, curve))
                all.push_back({check.observable, curve.name, curve.tail, farthest_place(curve, check.unit)});
        }
    for (Leftover& one : all)
        one.p_value = std::min(1.0, looks * one.p_value);
    std::erase_if(all, [](const Leftover& one) { return one.p_value > thresholds::kReported; });
    return all;
}

/// Nats that numbers of runs gain; runs that differ and jumps inside runs that are worth reporting.
std::pair<double, std::vector<Leftover>> left_by_runs(const Study& study, const State& state) {
    double nats = 0.0;
    std::vector<Leftover> left;
    const auto differences = run_differences(study.model(), state);
    const auto jumps = change_points(study.model(), state);
    const auto looks = static_cast<double>(differences.size());
    std::map<std::string, double> by_run;
    for (const RunDifference& one : differences) {
        const double p = std::min(1.0, looks * one.p_value);
        if (p < thresholds::kSure && one.gain > thresholds::kStandardErrors * one.sd)
            by_run[one.observable] = std::max(by_run[one.observable], one.gain);
        if (p < thresholds::kReported) left.push_back({one.observable, "run", p, one.shape});
    }
    for (const auto& [observable, gain] : by_run)
        nats += gain;
    for (const ChangePoint& one : jumps)
        if (one.p_value < thresholds::kReported)
            left.push_back({one.observable, "place in a run", one.p_value, one.shape});
    return {nats, std::move(left)};
}

}  // namespace

Diagnosis diagnosed(const Study& study, const Chosen& chosen, std::uint64_t seed) {
    const State &before = chosen.selection.none.fitted.state, &after = chosen.final.fitted.state;
    Diagnosis found;
    found.series = series_of(study.model(), before, after);
    const auto& observables = study.model().observables();
    found.leftovers = leftovers_of(study.experiment(), observables, found.series, seed);
    name_placements(study.experiment(), found);
    found.free_forms = free_forms_of(study.experiment(), study.model(), after, seed);
    const auto [left_by_run, of_runs] = left_by_runs(study, after);
    found.left_by_run = left_by_run;
    // Are the forms of the chosen effects told from their neighbours'?
    for (const Trial& step : chosen.selection.steps)
        found.forms.emplace_back(step.effect,
                                 form_verdict(rival_forms(study, chosen.selection.chosen, step.effect)));
    if (std::ranges::any_of(observables, is_replicated)) {
        found.predictive = predictive_checks(study, chosen.final, !chosen.final.effects.empty(), seed);
        const auto unlike = not_replicated(study, chosen.final.fitted.state, found.predictive);
        found.leftovers.insert(found.leftovers.end(), unlike.begin(), unlike.end());
    }
    found.structures = found.leftovers;
    const Selection& selection = chosen.selection;
    for (const auto& more : {of_runs, wandering(study, selection.chosen)})
        found.leftovers.insert(found.leftovers.end(), more.begin(), more.end());
    std::ranges::stable_sort(found.leftovers, {}, &Leftover::p_value);
    return found;
}

}  // namespace puckloop::gap
