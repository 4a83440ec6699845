#include "gap/diagnostics/scatter.h"

#include "gap/kinds/columns.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace puckloop::gap {

namespace {

constexpr double kFarthest = 3.0;  // deviations: single wild rows decide nothing

/// A weighted mean of what varies by one.
struct Mean {
    double sum = 0.0, weights = 0.0, squares = 0.0;
    void add(double one, double weight) {
        sum += weight * one;
        weights += weight;
        squares += weight * weight;
    }
    double value() const { return sum / weights; }
    double doubt() const { return std::sqrt(squares) / weights; }
};

/// Is this row a reading of the same as the one before it?
bool again(const Experiment& experiment, const Observable& o, std::size_t i) {
    if (i == 0 || o.starts[i] != 0 || o.run[i] != o.run[i - 1] || o.row[i] != o.row[i - 1] + 1) return false;
    for (const ColumnInfo& info : columns_of(experiment.kind)) {
        if (info.role != Role::Truth && info.role != Role::Stimulus) continue;
        const auto& column = experiment.runs[o.run[i]].column(info.name);
        if (!column.empty() && column[o.row[i]] != column[o.row[i - 1]]) return false;
    }
    return true;
}

bool inside(const Observable& o, std::size_t i) {
    return !o.instrument.at_end(o.y[i]);
}

}  // namespace

bool Contrast::moves_mean(std::size_t o) const {
    const auto same = [](double x, double y) { return x == y || (std::isnan(x) && std::isnan(y)); };
    return !std::ranges::equal(with[o].mean, without[o].mean, same);
}

bool Contrast::moves_rest(std::size_t o) const {
    Predicted one = with[o], other = without[o];
    one.mean.clear();  // may be NaN
    other.mean.clear();
    return one != other;
}

bool Contrast::moves_means() const {
    for (std::size_t o = 0; o < with.size(); ++o)
        if (moves_mean(o)) return true;
    return false;
}

bool Contrast::moves_more_than_means() const {
    for (std::size_t o = 0; o < with.size(); ++o)
        if (moves_rest(o)) return true;
    return false;
}

bool is_outlier(const Study& study, std::size_t effect) {
    return study.candidates()[effect].effect->role == EffectRole::Outlier;
}

Contrast contrast(const Study& study, const Fit& fit, std::span<const std::size_t> effects) {
    State state = fit.fitted.state;
    Contrast both{study.model().predicted(state.values), {}};
    for (const std::size_t effect : effects)
        state = study.without(effect, std::move(state));
    both.without = study.model().predicted(state.values);
    return both;
}

std::vector<std::size_t> scatter_effects(const Study& study, const Fit& fit) {
    const Prediction with = study.model().predicted(fit.fitted.state.values);
    std::vector<std::size_t> list;
    // A dead zone or a rail moves what is read, if not the mean before it.
    if (std::ranges::any_of(with, [](const Predicted& p) { return p.floor > 0 || p.ceiling > 0; }))
        return list;
    std::ranges::copy_if(fit.effects, std::back_inserter(list), [&](std::size_t effect) {
        return is_outlier(study, effect) || !contrast(study, fit, effect).moves_means();
    });
    return list;
}

std::vector<std::string> scattered_by(const Study& study, const Fit& fit,
                                      const std::vector<std::size_t>& effects) {
    const Contrast both = contrast(study, fit, effects);
    std::vector<std::string> names;
    for (std::size_t o = 0; o < both.with.size(); ++o)
        if (both.moves_rest(o)) names.push_back(study.model().observables()[o].name);
    return names;
}

bool lapses(const Study& study, const Fit& fit) {
    return !std::ranges::equal(study.model().predicted(fit.fitted.state.values),
                               study.model().predicted(study.model().neutral()), {}, &Predicted::lapse,
                               &Predicted::lapse);
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

double repeats_at_once(const Study& study, const Fit& fit, const std::vector<std::size_t>& scatter) {
    const auto [with, without] = contrast(study, fit, scatter);
    const auto costs = costs_at(study.model(), fit.fitted.state, with);
    Mean scattered, calm_rows;
    for (std::size_t o = 0; o < with.size(); ++o) {
        const Observable& observable = study.model().observables()[o];
        if (observable.noise != NoiseKind::Carry) continue;
        const auto& errors = costs[o].innovation;
        double squares = 0.0, rows = 0.0;
        const auto cut = [](double z) { return std::clamp(z, -kFarthest, kFarthest); };
        for (std::size_t i = 0; i < errors.size(); ++i)
            if (inside(observable, i)) squares += cut(errors[i]) * cut(errors[i]), rows += 1;
        if (!(squares > 0)) continue;
        // How much of a row's noise is the scatter's.
        const auto share = [&](std::size_t i) {
            const double own = row_sd(observable, without[o], fit.fitted.state.noise[o], i),
                         all = row_sd(observable, with[o], fit.fitted.state.noise[o], i);
            return std::clamp(1 - own * own / (all * all), 0.0, 1.0);
        };
        for (std::size_t i = 1; i < errors.size(); ++i) {
            if (!inside(observable, i) || !inside(observable, i - 1)) continue;
            if (!again(study.experiment(), observable, i)) continue;
            const double product = cut(errors[i]) * cut(errors[i - 1]) * rows / squares;
            scattered.add(product, share(i) * share(i - 1));
            calm_rows.add(product, (1 - share(i)) * (1 - share(i - 1)));
        }
    }
    if (!(scattered.weights > 0 && calm_rows.weights > 0)) return 0.0;
    return (scattered.value() - calm_rows.value()) / std::hypot(scattered.doubt(), calm_rows.doubt());
}

}  // namespace puckloop::gap
