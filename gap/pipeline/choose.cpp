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

std::string name_of(const Study& study, std::size_t candidate) {
    return study.candidates()[candidate].effect->name;
}

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

/// Tracker offset, tracker delay and sensor age fitted along, where the data tells them from the chosen set.
void add_nuisances(const Study& study, Chosen& chosen) {
    Fit& fit = chosen.final = chosen.selection.chosen;
    if (fit.effects.empty()) return;
    for (std::size_t i = 0; i < study.candidates().size(); ++i) {
        const Candidate& candidate = study.candidates()[i];
        if (!candidate.effect->fitted_along || !candidate.remark.empty() || contains(fit.effects, i))
            continue;
        auto set = fit.effects;
        set.push_back(i);
        Fit wider = study.fit_set(set, fit.fitted.state);
        if (any_is_fixed_by_another(study, wider)) continue;
        fit = std::move(wider);
        chosen.changes.push_back({name_of(study, i), "fitted along: every measuring chain has it"});
    }
}

/// What each cause says now that others are gone; those that say too little go, the weakest first. False: the
/// first of them would have to go.
bool weigh_again(const Study& study, Chosen& chosen) {
    Selection& selection = chosen.selection;
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
        const std::string why = "says too little without what was doubted beside it";
        selection.trials[least.effect].remark = why;
        chosen.changes.push_back({name_of(study, least.effect), why});
        selection.chosen = without_effects(study, selection.chosen, {least.effect});
        selection.held_chosen = study.hold_out(selection.chosen);
        selection.steps.erase(selection.steps.begin() + static_cast<std::ptrdiff_t>(weakest));
    }
}

}  // namespace

Chosen chosen_of(const Study& study, Selection selection) {
    Chosen chosen{std::move(selection), {}, {}};
    add_nuisances(study, chosen);
    return chosen;
}

std::optional<Chosen> without_doubted(const Study& study, const Chosen& all,
                                      const std::vector<std::size_t>& doubted, const std::string& doubt) {
    if (contains(doubted, all.selection.steps.front().effect)) return std::nullopt;
    Chosen rest{all.selection, {}, {}};
    Selection& selection = rest.selection;
    selection.chosen = without_effects(study, selection.chosen, doubted);
    selection.held_chosen = study.hold_out(selection.chosen);
    for (const std::size_t one : doubted) {
        selection.trials[one].remark = "comes nearest to what is left, but " + doubt;
        rest.changes.push_back({name_of(study, one), doubt});
    }
    std::erase_if(selection.steps, [&](const Trial& step) { return contains(doubted, step.effect); });
    if (!weigh_again(study, rest)) return std::nullopt;
    add_nuisances(study, rest);
    return rest;
}

Chosen taken_back(const Chosen& all, const std::string& doubt) {
    Chosen none = all;
    Selection& selection = none.selection;
    for (const Trial& step : selection.steps)
        selection.trials[step.effect].remark = "came nearest, but " + doubt;
    selection.steps.clear();
    selection.chosen = none.final = selection.none;
    selection.held_chosen = selection.held_none;
    none.changes.push_back({"all causes", doubt});
    return none;
}

}  // namespace puckloop::gap
