#include "gap/decide/roles.h"

#include "gap/decide/no_mechanism.h"
#include "gap/diagnostics/pushes.h"
#include "gap/diagnostics/scatter.h"
#include "gap/evidence/criterion.h"
#include "gap/evidence/thresholds.h"
#include "gap/fit/noise.h"
#include "gap/fit_test/run_differences.h"
#include "gap/fit_test/wander.h"
#include "gap/residual_model/free_form.h"
#include "gap/stats/series.h"
#include "gap/stats/tails.h"
#include "gap/validate/placements.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

namespace puckloop::gap {

namespace {

/// What the model lacks in its mean, seen without the effects that scatter.
std::string mean_behind(const Study& study, const Fit& fit, const HeldOut& held,
                        const std::vector<Leftover>& leftovers, const std::vector<std::size_t>& scatter,
                        std::uint64_t seed) {
    const auto touched = scattered_by(study, fit, scatter);
    if (touched.empty()) return "";
    const auto is_touched = [&](const std::string& name) { return stats::contains(touched, name); };
    const auto sure = [&](const Leftover& left) { return is_sure(left) && is_touched(left.observable); };
    for (const Leftover& left : leftovers)
        if (left.covariate == kPlacementCovariate && sure(left))
            return "explains scatter that repeats at each placement";
    if (stats::normal_tail(repeats_at_once(study, fit, scatter)) < thresholds::kSure)
        return "explains scatter that is there again at the next reading";
    const Fit calm = without_effects(study, fit, scatter);
    const double won = std::max(study.gain(study.hold_out(calm), held).sum, 0.0);
    const auto too_much = [&](double left) { return left > thresholds::kShareLeft * (left + won); };
    double by_run = 0.0;
    for (const RunDifference& one : run_differences(study.model(), calm.fitted.state))
        if (is_touched(one.observable) && one.p_value < thresholds::kSure)
            by_run = std::max(by_run, one.gain);
    if (by_run > 0 && too_much(by_run)) return "explains scatter that differs from run to run in its mean";
    const auto forms = free_forms_of(study.experiment(), study.model(), calm.fitted.state, seed, touched);
    const bool bursts = std::ranges::any_of(forms, [](const FreeForm& form) { return form.bursts; });
    if (bursts && lapses(study, fit)) return "explains scatter that comes in bursts";
    const double shaped = gained_by_shape(forms);
    if (shaped > 0 && too_much(shaped)) return "explains scatter that has a shape";
    // Larger errors cover any mean that the model lacks: with one that is left for sure, who knows how much.
    // How much a walk is worth is known.
    const auto is_left = [&](const Leftover& left) {
        return sure(left) && (left.covariate != kWanderCovariate || too_much(-std::log(left.p_value)));
    };
    return std::ranges::any_of(leftovers, is_left) ? "explains scatter beside a structure that is left" : "";
}

/// How large something is in the rows where it acts, which may be few: those that it moves most count most.
class Size {
  public:
    void add(double one) {
        if (!std::isfinite(one)) return;
        squares_ += one * one;
        fourths_ += one * one * one * one;
    }
    double value() const { return squares_ > 0 ? std::sqrt(fourths_ / squares_) : 0.0; }

  private:
    double squares_ = 0.0, fourths_ = 0.0;
};

/// Does nothing but the width of its errors differ of observable `o`, beside its mean?
bool widens_only(const Contrast& both, std::size_t o) {
    const auto rest = [](Predicted one) {
        one.mean.clear();
        one.factor.clear();
        one.extra.clear();
        return one;
    };
    return rest(both.with[o]) == rest(both.without[o]);
}

/// Does a law of errors without a mechanism do as well as the effects that make single errors large?
bool no_more_than_large_errors(const Study& study, const Fit& fit, const std::vector<std::size_t>& outliers) {
    const auto touched = scattered_by(study, fit, outliers);
    if (outliers.empty() || touched.empty()) return false;
    const Fit calm = without_effects(study, fit, outliers);
    // Other errors may follow that law with the cause and without it, so that they speak for neither. Both
    // fits saw these rows: a nat is taken off for each number that is fitted (Akaike 1974).
    auto gains = scores_with_large_errors(study, fit, touched);
    const auto by_law = scores_with_large_errors(study, calm, touched);
    const auto fitted = static_cast<double>(fit.freed.size() - calm.freed.size());
    for (std::size_t block = 0; block < gains.size(); ++block)
        gains[block] -= by_law[block] + fitted / static_cast<double>(gains.size());
    return !gains_enough(gain_of(gains), study.candidates().size(), outliers.size());
}

/// What an effect gains by the means it moves, of all it gains; NaN: it moves no mean.
double mean_share(const Study& study, const Fit& fit, std::size_t effect) {
    const Contrast both = contrast(study, fit, effect);
    if (!both.moves_means()) return std::numeric_limits<double>::quiet_NaN();
    if (!both.moves_more_than_means()) return 1.0;
    Prediction mean_only = both.without, rest_only = both.with;
    for (std::size_t o = 0; o < mean_only.size(); ++o)
        std::swap(mean_only[o].mean, rest_only[o].mean);
    const auto cost = [&](const Prediction& prediction) {
        return cost_of(study.model(), fit.fitted.state, prediction);
    };
    // What the means bring may be seen before or after the scatter that goes with them.
    const double all = cost(both.without), none = cost(both.with);
    const double first = all - cost(mean_only), last = cost(rest_only) - none;
    return all > none ? std::max(first, last) / (all - none) : 0.0;
}

}  // namespace

bool within_rounding(const Study& study, const Fit& fit, std::size_t effect) {
    const Contrast both = contrast(study, fit, effect);
    const bool scatters =
        both.moves_more_than_means() && study.candidates()[effect].effect->role != EffectRole::Mean;
    if (!both.moves_means() && !scatters) return false;
    for (std::size_t o = 0; o < both.with.size(); ++o) {
        const Observable& observable = study.model().observables()[o];
        Size moved, widened;
        for (std::size_t i = 0; i < observable.y.size(); ++i)
            moved.add(both.with[o].mean[i] - both.without[o].mean[i]);
        const double most = thresholds::kRounding * observable.instrument.quantum;
        if (moved.value() > most) return false;
        if (!scatters || !both.moves_rest(o)) continue;
        const NoiseParameters& noise = fit.fitted.state.noise[o];
        if (!widens_only(both, o) || !is_within_step(observable, noise)) return false;
        for (std::size_t i = 0; i < observable.y.size(); ++i) {
            const double with = row_sd(observable, both.with[o], noise, i),
                         without = row_sd(observable, both.without[o], noise, i);
            widened.add(std::sqrt(std::abs(with * with - without * without)));
        }
        if (widened.value() > most) return false;
    }
    return true;
}

OutOfRole out_of_role(const Study& study, const Fit& fit, const HeldOut& held,
                      const std::vector<Leftover>& leftovers, std::uint64_t seed) {
    const auto those = [&](const auto& are) {
        std::vector<std::size_t> effects;
        std::ranges::copy_if(fit.effects, std::back_inserter(effects), are);
        return effects;
    };
    auto doubted = those([&](std::size_t effect) { return within_rounding(study, fit, effect); });
    if (!doubted.empty()) return {doubted, "moves readings by no more than their rounding or cutting off"};
    doubted = those([&](std::size_t effect) {
        return study.candidates()[effect].effect->role == EffectRole::Mean &&
               mean_share(study, fit, effect) < thresholds::kMeanShare;
    });
    if (!doubted.empty()) return {doubted, "gains by larger errors, not by the means it moves"};
    const auto outliers = those([&](std::size_t effect) { return is_outlier(study, effect); });
    if (!outliers.empty() && push_pattern(study.experiment(), study.model(), fit.fitted.state))
        return {{outliers.front()},
                "keeps to a place, a command, a run or a direction, goes back, or shows in no row for sure; "
                "pushes do not"};
    if (no_more_than_large_errors(study, fit, outliers))
        return {outliers, "explains no more than errors of which a few are larger do",
                outliers.size() == fit.effects.size()};
    const auto scatter = scatter_effects(study, fit);
    if (scatter.empty()) return {};
    const std::string why = mean_behind(study, fit, held, leftovers, scatter, seed);
    return why.empty() ? OutOfRole{} : OutOfRole{scatter, why};
}

bool is_sure(const Leftover& left) {
    return left.p_value < (left.covariate == kWanderCovariate ? thresholds::kSureWalk : thresholds::kSure);
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

double left_of(std::vector<FreeForm> forms, std::vector<Leftover> leftovers,
               const std::function<bool(const std::string&)>& own) {
    const auto is_other = [&](const auto& one) { return !own(one.observable); };
    std::erase_if(forms, is_other);
    std::erase_if(leftovers, is_other);
    return std::max(gained_by_shape(forms), most_by_structure(leftovers));
}

}  // namespace puckloop::gap
