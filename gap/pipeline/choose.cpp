#include "gap/pipeline/choose.h"

#include "gap/decide/thresholds.h"
#include "gap/diagnostics/scatter.h"
#include "gap/evidence/criterion.h"
#include "gap/fit/intervals.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

using stats::contains;

/// Are two freed parameters one number for this data?
bool any_is_fixed_by_another(const Study& study, const Fit& fit) {
    const Precision precision = precision_of(study, fit);
    for (std::size_t j = 0; j < fit.freed.size(); ++j)
        for (std::size_t k = 0; k < j; ++k)
            if (std::abs(precision.correlation(static_cast<Eigen::Index>(j), static_cast<Eigen::Index>(k))) >
                thresholds::kOneNumber)
                return true;
    return false;
}

/// What each cause says now that others are gone; those that say too little go, the weakest first. False: the
/// first of them would have to go.
bool weigh_again(const Study& study, Selection& selection) {
    while (true) {
        std::size_t weakest = 0;
        for (Trial& step : selection.steps) {
            const Fit fewer = without_effects(study, selection.chosen, {step.effect});
            step.delta_bic = fewer.bic - selection.chosen.bic;
            step.held = study.gain(study.hold_out(fewer), selection.held_chosen);
            if (step.held.sum < selection.steps[weakest].held.sum)
                weakest = static_cast<std::size_t>(&step - selection.steps.data());
        }
        const Trial least = selection.steps[weakest];
        if (gains_enough(least.held, study.candidates().size(), 1)) return true;
        if (weakest == 0) return false;
        selection.trials[least.effect].remark = "says too little without what was doubted beside it";
        selection.chosen = without_effects(study, selection.chosen, {least.effect});
        selection.held_chosen = study.hold_out(selection.chosen);
        selection.steps.erase(selection.steps.begin() + static_cast<std::ptrdiff_t>(weakest));
    }
}

}  // namespace

Chosen chosen_of(const Study& study, Selection selection) {
    Chosen chosen{std::move(selection), {}};
    Fit& fit = chosen.final = chosen.selection.chosen;
    if (fit.effects.empty()) return chosen;
    for (std::size_t i = 0; i < study.candidates().size(); ++i) {
        const Candidate& candidate = study.candidates()[i];
        if (!candidate.effect->fitted_along || !candidate.remark.empty() || contains(fit.effects, i))
            continue;
        auto set = fit.effects;
        set.push_back(i);
        Fit wider = study.fit_set(set, fit.fitted.state);
        if (!any_is_fixed_by_another(study, wider)) fit = std::move(wider);
    }
    return chosen;
}

std::optional<Chosen> without_doubted(const Study& study, const Selection& all,
                                      const std::vector<std::size_t>& doubted, const std::string& doubt) {
    if (contains(doubted, all.steps.front().effect)) return std::nullopt;
    Selection selection = all;
    selection.chosen = without_effects(study, selection.chosen, doubted);
    selection.held_chosen = study.hold_out(selection.chosen);
    for (const std::size_t one : doubted)
        selection.trials[one].remark = "comes nearest to what is left, but " + doubt;
    std::erase_if(selection.steps, [&](const Trial& step) { return contains(doubted, step.effect); });
    if (!weigh_again(study, selection)) return std::nullopt;
    return chosen_of(study, std::move(selection));
}

Chosen taken_back(const Chosen& all, const std::string& doubt) {
    Chosen none = all;
    Selection& selection = none.selection;
    for (const Trial& step : selection.steps)
        selection.trials[step.effect].remark = "came nearest, but " + doubt;
    selection.steps.clear();
    selection.chosen = none.final = selection.none;
    selection.held_chosen = selection.held_none;
    return none;
}

}  // namespace puckloop::gap
