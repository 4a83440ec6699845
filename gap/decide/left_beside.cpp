#include "gap/decide/left_beside.h"

#include "gap/decide/no_mechanism.h"
#include "gap/decide/roles.h"
#include "gap/diagnostics/scatter.h"
#include "gap/evidence/thresholds.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace puckloop::gap {

namespace {

/// Observables whose prediction an effect changes.
std::vector<std::string> moved_by(const Study& study, const Fit& fit, std::size_t effect) {
    const Contrast both = contrast(study, fit, effect);
    std::vector<std::string> names;
    for (std::size_t o = 0; o < both.with.size(); ++o)
        if (both.moves_mean(o) || both.moves_rest(o)) names.push_back(study.model().observables()[o].name);
    return names;
}

/// Both axes of the room are one form.
bool is_of(const std::string& form, const std::string& observable) {
    return form == observable || (form == "place" && (observable == "x_m" || observable == "y_m"));
}

/// Is more left of some events that are moved than all causes together know of them beyond one chance for
/// all, which gives no reason for when, where and to whom they happen?
bool more_left_than_known(const Study& study, const Selection& selection, const std::vector<FreeForm>& forms,
                          const std::vector<Leftover>& leftovers, const std::vector<std::string>& moved) {
    const auto& observables = study.model().observables();
    for (std::size_t o = 0; o < observables.size(); ++o) {
        const std::string& own = observables[o].name;
        if (observables[o].noise != NoiseKind::Event || !stats::contains(moved, own)) continue;
        const double left = left_of(forms, leftovers, [&](const std::string& name) { return name == own; });
        if (!(left > 0)) continue;
        const double known = std::max(study.gain(selection.held_none, selection.held_chosen, o).sum -
                                          gained_by_rate(study, selection, o),
                                      0.0);
        if (left > thresholds::kShareLeftOfEvents * (left + known)) return true;
    }
    return false;
}

}  // namespace

std::vector<std::size_t> outweighed(const Study& study, const Selection& selection,
                                    const std::vector<FreeForm>& forms,
                                    const std::vector<Leftover>& leftovers, double share) {
    std::vector<std::size_t> weakest;
    double least = INFINITY;
    const auto& observables = study.model().observables();
    for (const Trial& step : selection.steps) {
        const auto moved = moved_by(study, selection.chosen, step.effect);
        const auto is_moved = [&](const std::string& name) {
            return std::ranges::any_of(moved, [&](const std::string& one) { return is_of(name, one); });
        };
        const double left = left_of(forms, leftovers, is_moved);
        const bool any_sum = std::ranges::any_of(observables, [&](const Observable& one) {
            return adds_up(one) && stats::contains(moved, one.name);
        });
        const double won = std::max(step.held.sum, 0.0);
        const double most = any_sum ? share : std::min(share, thresholds::kShareLeft);
        const bool too_much =
            left > most * (left + won) || more_left_than_known(study, selection, forms, leftovers, moved);
        if (!too_much || won >= least) continue;
        least = won;
        weakest = {step.effect};
    }
    return weakest;
}

}  // namespace puckloop::gap
