#include "gap/decide/left_beside.h"

#include "gap/decide/roles.h"
#include "gap/decide/thresholds.h"
#include "gap/diagnostics/scatter.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <cmath>
#include <iterator>
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
        std::vector<FreeForm> own_forms;
        std::vector<Leftover> own_leftovers;
        std::ranges::copy_if(forms, std::back_inserter(own_forms),
                             [&](const FreeForm& one) { return is_moved(one.observable); });
        std::ranges::copy_if(leftovers, std::back_inserter(own_leftovers),
                             [&](const Leftover& one) { return is_moved(one.observable); });
        const double left = std::max(gained_by_shape(own_forms), most_by_structure(own_leftovers));
        const bool any_sum = std::ranges::any_of(observables, [&](const Observable& one) {
            return adds_up(one) && stats::contains(moved, one.name);
        });
        const double won = std::max(step.held.sum, 0.0);
        const double most = any_sum ? share : std::min(share, thresholds::kShareLeft);
        if (!(left > most * (left + won)) || won >= least) continue;
        least = won;
        weakest = {step.effect};
    }
    return weakest;
}

}  // namespace puckloop::gap
