#include "gap/diagnostics/scatter.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::gap {

namespace {

bool same_means(const Prediction& a, const Prediction& b) {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return std::equal(a.begin(), a.end(), b.begin(), [&](const Predicted& one, const Predicted& other) {
        return std::equal(one.mean.begin(), one.mean.end(), other.mean.begin(), other.mean.end(), same);
    });
}

}  // namespace

std::vector<std::size_t> scatter_effects(const Study& study, const Fit& fit) {
    Prediction with, without;
    study.model().predict(fit.fitted.state.values, with);
    std::vector<std::size_t> list;
    // A dead zone or a rail moves what is read, if not the mean before it.
    if (std::any_of(with.begin(), with.end(),
                    [](const Predicted& p) { return p.floor > 0 || p.ceiling > 0; }))
        return list;
    for (const std::size_t effect : fit.effects) {
        study.model().predict(study.without(effect, fit.fitted.state).values, without);
        if (same_means(with, without)) list.push_back(effect);
    }
    return list;
}

std::vector<std::string> scattered_by(const Study& study, const Fit& fit,
                                      const std::vector<std::size_t>& effects) {
    State state = fit.fitted.state;
    for (const std::size_t effect : effects)
        state = study.without(effect, std::move(state));
    Prediction with, without;
    study.model().predict(fit.fitted.state.values, with);
    study.model().predict(state.values, without);
    std::vector<std::string> names;
    for (std::size_t o = 0; o < with.size(); ++o) {
        with[o].mean.clear();  // the same, and may be NaN
        without[o].mean.clear();
        if (with[o] != without[o]) names.push_back(study.model().observables()[o].name);
    }
    return names;
}

bool lapses(const Study& study, const Fit& fit) {
    Prediction prediction;
    study.model().predict(fit.fitted.state.values, prediction);
    return std::any_of(prediction.begin(), prediction.end(),
                       [](const Predicted& one) { return !one.lapse.empty(); });
}

Fit without_effects(const Study& study, const Fit& fit, const std::vector<std::size_t>& dropped) {
    std::vector<std::size_t> rest = fit.effects;
    State state = fit.fitted.state;
    for (const std::size_t effect : dropped) {
        std::erase(rest, effect);
        state = study.without(effect, std::move(state));
    }
    return rest.empty() ? study.fit_none() : study.fit_set(rest, state);
}

}  // namespace puckloop::gap
