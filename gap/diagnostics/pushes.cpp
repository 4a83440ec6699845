#include "gap/diagnostics/pushes.h"

#include "gap/fit/filter.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <vector>

namespace puckloop::gap {

namespace {

constexpr double kLeastPushes = 3.0;
constexpr double kByChance = 1e-3;  // corrected p above which nothing is reported
constexpr double kIsPush = 0.5;

/// What the rows of a model's pushed sums say.
struct Pushed {
    const Observable* base = nullptr;  ///< the first of them; null: there is none
    std::vector<double> chance;        ///< that a row is pushed, as fitted
    std::vector<double> pushed;        ///< how likely it was; one push shows in any of the sums
    std::map<std::string, std::vector<double>> news;  ///< of each sum, its unit
};

Pushed pushed_rows(const Model& model, const State& state) {
    const Prediction prediction = model.predicted(state.values);
    Pushed rows;
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const Observable& observable = model.observables()[o];
        if (observable.noise != NoiseKind::Level || prediction[o].lapse.empty() || observable.fixed_sd > 0)
            continue;
        if (rows.base != nullptr && observable.row != rows.base->row) continue;
        Innovations innovations;
        filter(observable, prediction[o], state.noise[o], innovations);
        if (rows.base == nullptr) {
            rows.base = &observable;
            rows.pushed.assign(observable.y.size(), 0.0);
            rows.chance = prediction[o].lapse;
        }
        std::vector<double>& news = rows.news[observable.name];
        for (std::size_t i = 0; i < rows.pushed.size(); ++i) {
            rows.pushed[i] = std::max(rows.pushed[i], innovations.pushed[i]);
            news.push_back(innovations.z[i] * std::sqrt(innovations.variance[i]));
        }
    }
    return rows;
}

/// Successive pushes of a run, and how many of them go against the one before.
struct Successive {
    unsigned pairs = 0, against = 0;
    double p_value() const { return stats::binomial_tail(pairs, 0.5, against); }
};

/// By the angle between them in the room.
Successive successive_shifts(const Experiment& experiment, const Pushed& rows) {
    const bool turned = rows.news.contains("along");
    const auto first = rows.news.find(turned ? "along" : "x_m"),
               second = rows.news.find(turned ? "across" : "y_m");
    Successive all;
    if (first == rows.news.end() || second == rows.news.end()) return all;
    double last_x = NAN, last_y = NAN;
    for (std::size_t i = 0; i < rows.pushed.size(); ++i) {
        if (rows.base->starts[i] != 0) last_x = last_y = NAN;
        if (rows.pushed[i] < kIsPush) continue;
        double x = first->second[i], y = second->second[i];
        if (turned) {
            const double heading = experiment.runs[rows.base->run[i]].column("theta_rad")[rows.base->row[i]];
            const double along = x;
            x = along * std::cos(heading) - y * std::sin(heading);
            y = along * std::sin(heading) + y * std::cos(heading);
        }
        const double same = x * last_x + y * last_y;
        if (std::isfinite(same)) {
            all.pairs += 1;
            all.against += same < 0 ? 1 : 0;
        }
        if (std::isfinite(x) && std::isfinite(y)) last_x = x, last_y = y;
    }
    return all;
}

/// By the sense in which they turn.
Successive successive_turns(const Pushed& rows) {
    const auto heading = rows.news.find("heading");
    Successive all;
    if (heading == rows.news.end()) return all;
    double last = NAN;
    for (std::size_t i = 0; i < rows.pushed.size(); ++i) {
        if (rows.base->starts[i] != 0) last = NAN;
        if (rows.pushed[i] < kIsPush || !std::isfinite(heading->second[i])) continue;
        const double same = heading->second[i] * last;
        if (std::isfinite(same)) {
            all.pairs += 1;
            all.against += same < 0 ? 1 : 0;
        }
        last = heading->second[i];
    }
    return all;
}

}  // namespace

std::optional<PushPattern> push_pattern(const Experiment& experiment, const Model& model,
                                        const State& state) {
    const Pushed rows = pushed_rows(model, state);
    if (rows.base == nullptr) return std::nullopt;
    PushPattern found;
    found.all = std::accumulate(rows.pushed.begin(), rows.pushed.end(), 0.0);
    const double hoped = std::accumulate(rows.chance.begin(), rows.chance.end(), 0.0);
    if (found.all < kLeastPushes || !(hoped > 0)) return std::nullopt;
    double tried = 0.0, least = 1.0;
    const auto look = [&](double p, double pushes, double expected, const std::string& where) {
        tried += 1;
        if (p >= least) return;
        least = p;
        found.where = where;
        found.pushes = pushes;
        found.expected = expected;
    };
    Series places;
    places.run = rows.base->run;
    places.row = rows.base->row;
    for (const stats::Component& component : free_form_cells(experiment, places, rows.base->starts)) {
        const auto there = stats::sums_of_cells(component, [&](std::size_t i) { return rows.pushed[i]; }),
                   share =
                       stats::sums_of_cells(component, [&](std::size_t i) { return rows.chance[i] / hoped; });
        for (std::size_t c = 0; c < there.size(); ++c)
            if (share[c] > 0)
                look(stats::binomial_tail(static_cast<unsigned>(std::ceil(found.all)), share[c],
                                          static_cast<unsigned>(std::floor(there[c]))),
                     there[c], share[c] * found.all, component.where[c]);
    }
    for (const Successive& one : {successive_shifts(experiment, rows), successive_turns(rows)})
        look(one.p_value(), one.against, one.pairs / 2.0, "against the push before");
    found.p_value = std::min(least * tried, 1.0);
    if (found.p_value > kByChance) return std::nullopt;
    return found;
}

}  // namespace puckloop::gap
