#include "gap/diagnostics/series.h"

#include "gap/fit/noise.h"
#include "gap/models/model.h"
#include "gap/stats/series.h"

#include <cmath>
#include <utility>

namespace puckloop::gap {

namespace {

/// Happened or not, less its probability, in one unit for all rows: what a change of the odds moves (the
/// score of a logistic regression). Over the row's own deviation one event where none is likely would say
/// more than all others.
void weigh_alike(Series& events) {
    double squares = 0.0;
    for (const double sd : events.scale)
        squares += sd * sd / static_cast<double>(events.scale.size());
    if (!(squares > 0)) return;
    for (std::size_t i = 0; i < events.scale.size(); ++i) {
        events.innovation_before[i] = (events.measured[i] - events.before[i]) / std::sqrt(squares);
        events.innovation_after[i] = (events.measured[i] - events.after[i]) / std::sqrt(squares);
    }
}

}  // namespace

std::vector<Series> series_of(const Model& model, const State& before, const State& after) {
    const Prediction old_prediction = model.predicted(before.values),
                     new_prediction = model.predicted(after.values);
    const auto old_costs = costs_at(model, before, old_prediction),
               new_costs = costs_at(model, after, new_prediction);
    std::vector<Series> all;
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const Observable& observable = model.observables()[o];
        // Rows of a run in the order they were measured.
        const auto order = stats::ordered(observable.y.size(), [&](std::size_t a, std::size_t b) {
            return std::pair(observable.run[a], observable.row[a]) <
                   std::pair(observable.run[b], observable.row[b]);
        });
        Series one;
        one.observable = observable.name;
        one.unit = observable.unit;
        one.events = observable.noise == NoiseKind::Event;
        for (const std::size_t i : order) {
            one.run.push_back(observable.run[i]);
            one.row.push_back(observable.row[i]);
            one.measured.push_back(observable.y[i]);
            one.before.push_back(shown(old_prediction[o], i));
            one.after.push_back(shown(new_prediction[o], i));
            one.scale.push_back(row_sd(observable, new_prediction[o], after.noise[o], i));
            one.innovation_before.push_back(old_costs[o].innovation[i]);
            one.innovation_after.push_back(new_costs[o].innovation[i]);
        }
        if (one.events) weigh_alike(one);
        all.push_back(std::move(one));
    }
    return all;
}

}  // namespace puckloop::gap
