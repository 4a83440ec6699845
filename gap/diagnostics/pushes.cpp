#include "gap/diagnostics/pushes.h"

#include "gap/fit/filter.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/stats/tails.h"

#include <algorithm>
#include <array>
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

struct Push {
    bool begins;          ///< the first of its run
    double x, y, turned;  ///< by how much, in the room and about the axle; NaN where no sum says
};

std::vector<Push> pushes_of(const Experiment& experiment, const Pushed& rows) {
    const auto news = [&](const char* sum, std::size_t i) {
        const auto found = rows.news.find(sum);
        return found == rows.news.end() ? NAN : found->second[i];
    };
    const bool along = rows.news.contains("along");
    std::vector<Push> pushes;
    bool begins = true;
    for (std::size_t i = 0; i < rows.pushed.size(); ++i) {
        begins = begins || rows.base->starts[i] != 0;
        if (rows.pushed[i] < kIsPush) continue;
        const double x = news(along ? "along" : "x_m", i), y = news(along ? "across" : "y_m", i);
        // The sums stand along the robot's axes or the room's.
        const double heading =
            along ? experiment.runs[rows.base->run[i]].column("theta_rad")[rows.base->row[i]] : 0.0;
        pushes.push_back({begins, x * std::cos(heading) - y * std::sin(heading),
                          x * std::sin(heading) + y * std::cos(heading), news("heading", i)});
        begins = false;
    }
    return pushes;
}

/// Successive pushes of a run, and how many of them go against the one before.
struct Successive {
    unsigned pairs = 0, against = 0;

    void take(double product) {
        if (!std::isfinite(product)) return;
        pairs += 1;
        against += product < 0 ? 1 : 0;
    }
    double p_value() const { return stats::binomial_tail(pairs, 0.5, against); }
};

/// By the angle between them in the room, and by the sense in which they turn.
std::array<Successive, 2> successive(const std::vector<Push>& pushes) {
    std::array<Successive, 2> all;
    for (std::size_t k = 1; k < pushes.size(); ++k) {
        const Push &last = pushes[k - 1], &now = pushes[k];
        if (now.begins) continue;
        all[0].take(now.x * last.x + now.y * last.y);
        all[1].take(now.turned * last.turned);
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
    for (const Successive& one : successive(pushes_of(experiment, rows)))
        look(one.p_value(), one.against, one.pairs / 2.0, "against the push before");
    found.p_value = std::min(least * tried, 1.0);
    if (found.p_value > kByChance) return std::nullopt;
    return found;
}

}  // namespace puckloop::gap
