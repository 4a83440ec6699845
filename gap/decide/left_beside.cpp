#include "gap/decide/left_beside.h"

#include "gap/decide/roles.h"
#include "gap/decide/thresholds.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

namespace puckloop::gap {

namespace {

/// Observables whose prediction an effect changes.
std::vector<std::string> moved_by(const Study& study, const Fit& fit, std::size_t effect) {
    Prediction with, without;
    study.model().predict(fit.fitted.state.values, with);
    study.model().predict(study.without(effect, fit.fitted.state).values, without);
    const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
    std::vector<std::string> names;
    for (std::size_t o = 0; o < with.size(); ++o) {
        const bool means =
            std::equal(with[o].mean.begin(), with[o].mean.end(), without[o].mean.begin(), same);
        with[o].mean.clear();
        without[o].mean.clear();
        if (!means || with[o] != without[o]) names.push_back(study.model().observables()[o].name);
    }
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
            return std::any_of(moved.begin(), moved.end(),
                               [&](const std::string& one) { return is_of(name, one); });
        };
        std::vector<FreeForm> own_forms;
        std::vector<Leftover> own_leftovers;
        std::copy_if(forms.begin(), forms.end(), std::back_inserter(own_forms),
                     [&](const FreeForm& one) { return is_moved(one.observable); });
        std::copy_if(leftovers.begin(), leftovers.end(), std::back_inserter(own_leftovers),
                     [&](const Leftover& one) { return is_moved(one.observable); });
        const double left = std::max(gained_by_shape(own_forms), most_by_structure(own_leftovers));
        const bool any_sum = std::any_of(observables.begin(), observables.end(), [&](const Observable& one) {
            return adds_up(one) && std::find(moved.begin(), moved.end(), one.name) != moved.end();
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
