#include "gap/pipeline/judge.h"

#include "gap/decide/left_beside.h"
#include "gap/decide/roles.h"
#include "gap/diagnostics/scatter.h"
#include "gap/evidence/criterion.h"
#include "gap/fit/intervals.h"
#include "gap/fit_test/wander.h"
#include "gap/identify/known.h"
#include "gap/identify/robot_clock.h"
#include "gap/pipeline/weigh.h"
#include "gap/stats/series.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace puckloop::gap {

namespace {

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

/// Without effects that are doubted by themselves. None: one of them is the first, which the others were
/// built on, or the first would have to go for saying too little alone.
std::optional<Chosen> without_doubted(const Study& study, const Selection& all,
                                      const std::vector<std::size_t>& doubted, const std::string& doubt) {
    if (stats::contains(doubted, all.steps.front().effect)) return std::nullopt;
    Selection selection = all;
    selection.chosen = without_effects(study, selection.chosen, doubted);
    selection.held_chosen = study.hold_out(selection.chosen);
    for (const std::size_t one : doubted)
        selection.trials[one].remark = "comes nearest to what is left, but " + doubt;
    std::erase_if(selection.steps, [&](const Trial& step) { return stats::contains(doubted, step.effect); });
    if (!weigh_again(study, selection)) return std::nullopt;
    return chosen_of(study, std::move(selection));
}

/// Without any: an effect fitted to what it does not describe soaks up some of it and leaves much.
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

/// Causes that are doubted by themselves go where the first of them stands without them; then true, and those
/// that stay have to be asked again.
bool stands_without(const Study& study, const Judging& how, const std::vector<std::size_t>& doubted,
                    const std::string& why, Judged& result) {
    auto rest = without_doubted(study, result.chosen.selection, doubted, why);
    if (!rest) return false;
    for (const std::size_t one : doubted)
        result.cautions.push_back(fmt::format("{} would have to be part of it, but {}: not named",
                                              study.candidates()[one].effect->name, why));
    result.chosen = std::move(*rest);
    result.diagnosis = diagnosed(study, result.chosen, how.seed);
    result.grounds = grounds_of(study, result.chosen, result.diagnosis, how.seed);
    return true;
}

/// The same of causes that are out of their role.
bool let_go(const Study& study, const Judging& how, const OutOfRole& out, Judged& result) {
    if (out.effects.empty()) return false;
    if (stands_without(study, how, out.effects, out.why, result)) return true;
    result.grounds.out_of_role = out.why;
    result.grounds.law_alone = out.law_alone;
    return false;
}

/// The same of causes that these data cannot identify.
bool identified(const Study& study, const Judging& how, Judged& result) {
    for (const auto& ask : {not_by_clock, not_by_counts, not_known}) {
        const NotIdentified out = ask(study, result.chosen.selection.chosen);
        if (out.effects.empty()) continue;
        if (stands_without(study, how, out.effects, out.why, result)) return false;
        result.grounds.not_identified = out.why;
        result.not_identified = out.effects;
        return true;
    }
    return true;
}

/// Effects after the first that may as well be nothing: the 90 % intervals of all their numbers hold the
/// neutral value. Where rows jump with a number they may gain all the same.
std::vector<std::size_t> maybe_nothing(const Study& study, const Selection& selection) {
    std::vector<std::size_t> effects;
    if (selection.steps.size() < 2) return effects;
    const Fit& fit = selection.chosen;
    const Precision precision = precision_of(study, fit);
    const auto may_be_nothing = [&](const Freed& freed) {
        const auto j = std::ranges::find(fit.freed, freed.index, &Freed::index) - fit.freed.begin();
        const Interval known = interval_of(study, fit, precision, static_cast<std::size_t>(j));
        const double neutral = study.model().parameters()[freed.index].neutral;
        return known.low <= neutral && neutral <= known.high;
    };
    for (const Trial& step : std::span(selection.steps).subspan(1))
        if (std::ranges::all_of(study.candidates()[step.effect].freed, may_be_nothing))
            effects.push_back(step.effect);
    return effects;
}

void ask_each(const Study& study, const Judging& how, Judged& result) {
    const Diagnosis& found = result.diagnosis;
    // That a sum wanders as well takes nothing from what a cause makes of it.
    std::vector<Leftover> structures = found.leftovers;
    std::erase_if(structures, [](const Leftover& one) { return one.covariate == kWanderCovariate; });
    let_go(study, how,
           {outweighed(study, result.chosen.selection, found.free_forms, structures, share_allowed(study)),
            "leaves too much of what it acts on"},
           result);
}

}  // namespace

Judged judged(const Study& study, Chosen chosen, Diagnosis diagnosis, const Judging& how) {
    Judged result;
    result.chosen = std::move(chosen);
    result.diagnosis = std::move(diagnosis);
    Grounds& g = result.grounds = grounds_of(study, result.chosen, result.diagnosis, how.seed);
    const auto goes_on = [&] { return g.causes > 0 && doubt_of(g).empty(); };
    const auto roles = [&] {
        const Selection& selection = result.chosen.selection;
        return out_of_role(study, selection.chosen, selection.held_chosen, result.diagnosis.leftovers,
                           how.seed);
    };
    const auto confirmation = [&] {
        return not_confirmed(study, result.chosen.selection, share_allowed(study), how.ask);
    };
    if (goes_on()) ask_each(study, how, result);
    if (goes_on())
        let_go(study, how, {maybe_nothing(study, result.chosen.selection), "it may as well be nothing"},
               result);
    while (goes_on() && let_go(study, how, roles(), result)) {
    }
    while (goes_on() && !identified(study, how, result)) {
    }
    if (goes_on() && how.ask) g.not_confirmed = confirmation();
    result.doubt = doubt_of(g);
    if (how.ask_all && how.ask && !result.doubt.empty()) {  // since something spoke before it
        if (g.out_of_role.empty()) g.out_of_role = roles().why;
        if (g.not_confirmed.empty()) g.not_confirmed = confirmation();
    }
    result.decision = decision_of(g, result.doubt);
    Grounds standing = g;
    if (!result.doubt.empty()) {
        Chosen none = taken_back(result.chosen, result.doubt);
        result.refused = std::move(result.chosen);
        result.refused_forms = std::move(result.diagnosis.forms);
        result.chosen = std::move(none);
        result.diagnosis = diagnosed(study, result.chosen, how.seed);
        // What the causes had covered is open now.
        standing = grounds_of(study, result.chosen, result.diagnosis, how.seed);
        if (result.decision == Decision::NoEffect) result.decision = decision_of(standing, "");
    }
    result.unexplained = standing.unexplained();
    result.found = std::max(standing.causes > 0 ? standing.gain.sum : 0.0, 0.0) + standing.left();
    return result;
}

}  // namespace puckloop::gap
