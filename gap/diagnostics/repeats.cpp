#include "gap/diagnostics/repeats.h"

#include "gap/data/columns.h"

#include <algorithm>
#include <cmath>

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

double repeats_at_once(const Study& study, const Fit& fit, const std::vector<std::size_t>& scatter) {
    Prediction with, without;
    const auto costs = costs_at(study.model(), fit.fitted.state, with);
    State calm = fit.fitted.state;
    for (const std::size_t effect : scatter)
        calm = study.without(effect, std::move(calm));
    study.model().predict(calm.values, without);
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
