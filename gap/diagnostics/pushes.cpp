#include "gap/diagnostics/pushes.h"

#include "gap/fit/filter.h"
#include "gap/residual_model/free_form_cells.h"
#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kLeastPushes = 3.0;
constexpr double kByChance = 1e-3;  // corrected p above which nothing is reported

}  // namespace

std::optional<PushPattern> push_pattern(const Experiment& experiment, const Model& model,
                                        const State& state) {
    const Prediction prediction = model.predicted(state.values);
    const Observable* base = nullptr;
    std::vector<double> pushed, chance;
    for (std::size_t o = 0; o < model.observables().size(); ++o) {
        const Observable& observable = model.observables()[o];
        if (observable.noise != NoiseKind::Level || prediction[o].lapse.empty() || observable.fixed_sd > 0)
            continue;
        if (base != nullptr && observable.row != base->row) continue;
        Innovations innovations;
        filter(observable, prediction[o], state.noise[o], innovations);
        if (base == nullptr) {
            base = &observable;
            pushed.assign(observable.y.size(), 0.0);
            chance = prediction[o].lapse;
        }
        // One push shows in any of the sums.
        for (std::size_t i = 0; i < pushed.size(); ++i)
            pushed[i] = std::max(pushed[i], innovations.pushed[i]);
    }
    if (base == nullptr) return std::nullopt;
    PushPattern found;
    double hoped = 0.0;
    for (std::size_t i = 0; i < pushed.size(); ++i) {
        found.all += pushed[i];
        hoped += chance[i];
    }
    if (found.all < kLeastPushes || !(hoped > 0)) return std::nullopt;
    Series rows;
    rows.run = base->run;
    rows.row = base->row;
    const auto components = free_form_cells(experiment, rows, base->starts);
    double tried = 0.0, least = 1.0;
    for (const stats::Component& component : components) {
        const auto there = stats::sums_of_cells(component, [&](std::size_t i) { return pushed[i]; }),
                   share = stats::sums_of_cells(component, [&](std::size_t i) { return chance[i] / hoped; });
        for (std::size_t c = 0; c < there.size(); ++c) {
            if (share[c] <= 0) continue;
            tried += 1;
            const double p = stats::binomial_tail(static_cast<unsigned>(std::ceil(found.all)), share[c],
                                                  static_cast<unsigned>(std::floor(there[c])));
            if (p >= least) continue;
            least = p;
            found.where = component.where[c];
            found.pushes = there[c];
            found.expected = share[c] * found.all;
        }
    }
    found.p_value = std::min(least * tried, 1.0);
    if (found.p_value > kByChance) return std::nullopt;
    return found;
}

}  // namespace puckloop::gap
