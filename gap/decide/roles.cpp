#include "gap/decide/roles.h"

#include "gap/decide/large_errors.h"
#include "gap/decide/thresholds.h"
#include "gap/diagnostics/pushes.h"
#include "gap/diagnostics/repeats.h"
#include "gap/diagnostics/scatter.h"
#include "gap/evidence/criterion.h"
#include "gap/fit_test/run_differences.h"
#include "gap/residual_model/free_form.h"
#include "gap/stats/tails.h"
#include "gap/validate/placements.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>

namespace puckloop::gap {

namespace {

double cost_of(const Study& study, const State& state, const Prediction& prediction) {
    double sum = 0.0;
    RowCosts costs;
    for (std::size_t o = 0; o < prediction.size(); ++o) {
        row_costs(study.model().observables()[o], prediction[o], state.noise[o], costs);
        sum = std::accumulate(costs.cost.begin(), costs.cost.end(), sum);
    }
    return sum;
}

bool moves_means(const Prediction& a, const Prediction& b) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    for (std::size_t o = 0; o < a.size(); ++o)
        if (!std::equal(a[o].mean.begin(), a[o].mean.end(), b[o].mean.begin(), b[o].mean.end(), same))
            return true;
    return false;
}

bool moves_more_than_means(const Prediction& a, const Prediction& b) {
    for (std::size_t o = 0; o < a.size(); ++o) {
        Predicted one = a[o];
        one.mean = b[o].mean;
        if (one != b[o]) return true;
    }
    return false;
}

/// What the model lacks in its mean, seen without the effects that scatter.
std::string mean_behind(const Study& study, const Fit& fit, const HeldOut& held,
                        const std::vector<Leftover>& leftovers, const std::vector<std::size_t>& scatter,
                        std::uint64_t seed) {
    const auto touched = scattered_by(study, fit, scatter);
    if (touched.empty()) return "";
    const auto is_touched = [&](const std::string& name) {
        return std::find(touched.begin(), touched.end(), name) != touched.end();
    };
    const auto sure = [&](const Leftover& left) {
        return left.p_value < thresholds::kSure && is_touched(left.observable);
    };
    for (const Leftover& left : leftovers)
        if (left.covariate == kPlacementCovariate && sure(left))
            return "explains scatter that repeats at each placement";
    if (stats::normal_tail(repeats_at_once(study, fit, scatter)) < thresholds::kSure)
        return "explains scatter that is there again at the next reading";
    const Fit calm = without_effects(study, fit, scatter);
    const double won = std::max(gain_of(gains_by_block(study.blocks(), study.hold_out(calm), held)).sum, 0.0);
    const auto too_much = [&](double left) { return left > thresholds::kShareLeft * (left + won); };
    double by_run = 0.0;
    for (const RunDifference& one : run_differences(study.model(), calm.fitted.state))
        if (is_touched(one.observable) && one.p_value < thresholds::kSure)
            by_run = std::max(by_run, one.gain);
    if (by_run > 0 && too_much(by_run)) return "explains scatter that differs from run to run in its mean";
    const auto forms = free_forms_of(study.experiment(), study.model(), calm.fitted.state, seed, touched);
    const bool bursts =
        std::any_of(forms.begin(), forms.end(), [](const FreeForm& form) { return form.spells; });
    if (bursts && lapses(study, fit)) return "explains scatter that comes in bursts";
    const double shaped = gained_by_shape(forms);
    if (shaped > 0 && too_much(shaped)) return "explains scatter that has a shape";
    // Larger errors cover any mean that the model lacks: with one that is left for sure, who knows how much.
    return std::any_of(leftovers.begin(), leftovers.end(), sure)
               ? "explains scatter beside a structure that is left"
               : "";
}

/// The effects that make single errors large, if a law of errors without a mechanism does as well.
std::vector<std::size_t> no_more_than_large_errors(const Study& study, const Fit& fit) {
    std::vector<std::size_t> outliers;
    for (const std::size_t effect : fit.effects)
        if (study.candidates()[effect].effect->role == EffectRole::Outlier) outliers.push_back(effect);
    const auto touched = scattered_by(study, fit, outliers);
    if (outliers.empty() || touched.empty()) return {};
    const Fit calm = without_effects(study, fit, outliers);
    // Other errors may follow that law with the cause and without it, so that they speak for neither. Both
    // fits saw these rows: a nat is taken off for each number that is fitted (Akaike 1974).
    auto gains = scores_with_large_errors(study, fit, touched);
    const auto by_law = scores_with_large_errors(study, calm, touched);
    const auto fitted = static_cast<double>(fit.freed.size() - calm.freed.size());
    for (std::size_t block = 0; block < gains.size(); ++block)
        gains[block] -= by_law[block] + fitted / static_cast<double>(gains.size());
    return gains_enough(gain_of(gains), study.candidates().size(), outliers.size())
               ? std::vector<std::size_t>{}
               : outliers;
}

}  // namespace

double mean_share(const Study& study, const Fit& fit, std::size_t effect) {
    const State& whole = fit.fitted.state;
    const State without = study.without(effect, whole);
    Prediction with_it, without_it;
    study.model().predict(whole.values, with_it);
    study.model().predict(without.values, without_it);
    if (!moves_means(with_it, without_it)) return std::numeric_limits<double>::quiet_NaN();
    if (!moves_more_than_means(with_it, without_it)) return 1.0;
    Prediction mean_only = without_it, rest_only = with_it;
    for (std::size_t o = 0; o < with_it.size(); ++o) {
        mean_only[o].mean = with_it[o].mean;
        rest_only[o].mean = without_it[o].mean;
    }
    // What the means bring may be seen before or after the scatter that goes with them.
    const double all = cost_of(study, whole, without_it), none = cost_of(study, whole, with_it);
    const double first = all - cost_of(study, whole, mean_only),
                 last = cost_of(study, whole, rest_only) - none;
    return all > none ? std::max(first, last) / (all - none) : 0.0;
}

bool within_rounding(const Study& study, const Fit& fit, std::size_t effect) {
    Prediction with, without;
    study.model().predict(fit.fitted.state.values, with);
    study.model().predict(study.without(effect, fit.fitted.state).values, without);
    if (!moves_means(with, without)) return false;
    if (study.candidates()[effect].effect->role != EffectRole::Mean && moves_more_than_means(with, without))
        return false;
    for (std::size_t o = 0; o < with.size(); ++o) {
        const Observable& observable = study.model().observables()[o];
        double squares = 0.0, fourths = 0.0;
        for (std::size_t i = 0; i < observable.y.size(); ++i) {
            const double moved = with[o].mean[i] - without[o].mean[i];
            if (!std::isfinite(moved)) continue;
            squares += moved * moved;
            fourths += moved * moved * moved * moved;
        }
        // Rows that it moves most count most: it may act in few of them.
        const double size = squares > 0 ? std::sqrt(fourths / squares) : 0.0;
        if (size > thresholds::kRounding * observable.instrument.quantum) return false;
    }
    return true;
}

OutOfRole out_of_role(const Study& study, const Fit& fit, const HeldOut& held,
                      const std::vector<Leftover>& leftovers, std::uint64_t seed) {
    OutOfRole result;
    for (const std::size_t effect : fit.effects)
        if (within_rounding(study, fit, effect)) result.effects.push_back(effect);
    if (!result.effects.empty()) {
        result.why = "moves readings by no more than their rounding";
        return result;
    }
    for (const std::size_t effect : fit.effects) {
        if (study.candidates()[effect].effect->role != EffectRole::Mean) continue;
        if (mean_share(study, fit, effect) < thresholds::kMeanShare) result.effects.push_back(effect);
    }
    if (!result.effects.empty()) {
        result.why = "gains by larger errors, not by the means it moves";
        return result;
    }
    for (const std::size_t effect : fit.effects)
        if (study.candidates()[effect].effect->role == EffectRole::Outlier &&
            push_pattern(study.experiment(), study.model(), fit.fitted.state)) {
            result.effects.push_back(effect);
            result.why = "keeps to a place, a command or a run, and chance does not";
            return result;
        }
    result.effects = no_more_than_large_errors(study, fit);
    if (!result.effects.empty()) {
        result.why = "explains no more than errors of which a few are larger do";
        result.law_alone = result.effects.size() == fit.effects.size();
        return result;
    }
    const auto scatter = scatter_effects(study, fit);
    if (scatter.empty()) return result;
    result.why = mean_behind(study, fit, held, leftovers, scatter, seed);
    if (!result.why.empty()) result.effects = scatter;
    return result;
}

double gained_by_shape(const std::vector<FreeForm>& forms) {
    double sum = 0.0;
    for (const FreeForm& form : forms)
        if (form.clear && !form.wild) sum += form.gain;
    return sum;
}

double most_by_structure(const std::vector<Leftover>& leftovers) {
    double most = 0.0;
    for (const Leftover& one : leftovers) {
        if (!(one.p_value < thresholds::kSure)) continue;
        const double p = std::max(one.p_value, std::numeric_limits<double>::min());
        most = std::max(most, -1 - std::log(p) - std::log(-std::log(p)));
    }
    return most;
}

LeftByRuns left_by_runs(const Study& study, const State& state) {
    LeftByRuns left;
    const auto differences = run_differences(study.model(), state);
    const auto jumps = change_points(study.model(), state);
    const auto looks = static_cast<double>(differences.size());
    std::map<std::string, double> by_run;
    for (const RunDifference& one : differences) {
        const double p = std::min(1.0, looks * one.p_value);
        if (p < thresholds::kSure && one.gain > thresholds::kStandardErrors * one.sd)
            by_run[one.observable] = std::max(by_run[one.observable], one.gain);
        if (p < thresholds::kReported) left.structures.push_back({one.observable, "run", p, one.shape});
    }
    for (const auto& [observable, gain] : by_run)
        left.by_run += gain;
    for (const ChangePoint& one : jumps)
        if (one.p_value < thresholds::kReported)
            left.structures.push_back({one.observable, "place in a run", one.p_value, one.shape});
    return left;
}

}  // namespace puckloop::gap
