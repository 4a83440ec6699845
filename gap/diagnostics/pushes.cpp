#include "gap/diagnostics/pushes.h"

#include "gap/diagnostics/push_directions.h"
#include "gap/fit/filter.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>
#include <utility>
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
    std::map<std::string, std::vector<double>> moved;  ///< how far, by each sum, its unit
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
        for (std::size_t i = 0; i < rows.pushed.size(); ++i)
            rows.pushed[i] = std::max(rows.pushed[i], innovations.pushed[i]);
        rows.moved[observable.name] = std::move(innovations.off);
    }
    return rows;
}

std::vector<Push> pushes_of(const Experiment& experiment, const Pushed& rows) {
    const auto moved = [&](const char* sum, std::size_t i) {
        const auto found = rows.moved.find(sum);
        return found == rows.moved.end() ? NAN : found->second[i];
    };
    const bool along = rows.moved.contains("along");
    std::vector<Push> pushes;
    bool begins = true;
    for (std::size_t i = 0; i < rows.pushed.size(); ++i) {
        begins = begins || rows.base->starts[i] != 0;
        if (rows.pushed[i] < kIsPush) continue;
        const double x = moved(along ? "along" : "x_m", i), y = moved(along ? "across" : "y_m", i),
                     heading = experiment.runs[rows.base->run[i]].column("theta_rad")[rows.base->row[i]];
        // The sums stand along the robot's axes or the room's.
        const double turn = along ? heading : 0.0;
        pushes.push_back({begins, x * std::cos(turn) - y * std::sin(turn),
                          x * std::sin(turn) + y * std::cos(turn), heading, moved("heading", i)});
        begins = false;
    }
    return pushes;
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
    for (const PushDirection& one : push_directions(pushes_of(experiment, rows)))
        look(one.p_value, one.pushes, one.expected, one.where);
    found.p_value = std::min(least * tried, 1.0);
    if (found.p_value > kByChance) return std::nullopt;
    return found;
}

}  // namespace puckloop::gap
