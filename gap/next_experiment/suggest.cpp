#include "gap/next_experiment/suggest.h"

#include "gap/next_experiment/designs.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostSuggestions = 5;
constexpr int kPoints = 81;     // of the quadrature
constexpr double kReach = 6.0;  // sd, of the quadrature

/// Information (bits) about which of two equally likely models is true, from data whose log likelihood ratio
/// has the mean `nats` (normal, variance twice the mean).
double bits_of(double nats) {
    if (nats <= 1e-9) return 0.0;
    const double sd = std::sqrt(2 * nats);
    double lost = 0.0, weights = 0.0;
    for (int k = 0; k < kPoints; ++k) {
        const double z = kReach * (2.0 * k / (kPoints - 1) - 1);
        const double weight = std::exp(-z * z / 2);
        const double ratio = nats + sd * z;
        lost += weight * (ratio < -30 ? -ratio : std::log1p(std::exp(-ratio))) / std::numbers::ln2;
        weights += weight;
    }
    return std::max(0.0, 1 - lost / weights);
}

/// A fitted state's parameters in another experiment's model, by name; the noise is the measured one.
State carried(const Model& from, const State& state, const Model& to) {
    State out{to.neutral(), {}};
    for (std::size_t i = 0; i < to.parameters().size(); ++i)
        if (const auto index = from.find(to.parameters()[i].name)) out.values[i] = state.values[*index];
    for (const Observable& observable : to.observables()) {
        NoiseParameters noise;
        for (std::size_t o = 0; o < from.observables().size(); ++o)
            if (from.observables()[o].name == observable.name) noise = state.noise[o];
        out.noise.push_back(noise);
    }
    return out;
}

/// Expected log likelihood ratio for `truth` over `other` on the design: the data is what `truth` predicts.
double expected_nats(const Model& design, const State& truth, const State& other) {
    Prediction from_truth, from_other;
    design.predict(truth.values, from_truth);
    design.predict(other.values, from_other);
    double sum = 0.0;
    RowCosts costs;
    for (std::size_t o = 0; o < design.observables().size(); ++o) {
        Observable as_if = design.observables()[o];
        const auto& p = from_truth[o].mean;
        const auto& q = from_other[o].mean;
        if (as_if.noise == NoiseKind::Event) {
            for (std::size_t i = 0; i < p.size(); ++i) {
                const double a = std::clamp(p[i], 1e-3, 1 - 1e-3), b = std::clamp(q[i], 1e-3, 1 - 1e-3);
                sum += a * std::log(a / b) + (1 - a) * std::log((1 - a) / (1 - b));
            }
            continue;
        }
        as_if.y = p;
        row_costs(as_if, from_truth[o], truth.noise[o], costs);
        for (std::size_t i = 0; i < p.size(); ++i)
            sum -= costs.cost[i];
        row_costs(as_if, from_other[o], truth.noise[o], costs);
        for (std::size_t i = 0; i < p.size(); ++i)
            sum += costs.cost[i];
    }
    return std::max(sum, 0.0);
}

}  // namespace

std::vector<Suggestion> suggestions_for(const Study& study, const Selection& selection) {
    std::vector<Suggestion> out;
    if (selection.draws.empty()) return out;
    const Draw& draw = selection.draws.front();
    const auto name = [&](std::size_t candidate) {
        return std::string(study.candidates()[candidate].effect->name);
    };
    for (const Design& design : designs_of(study.experiment())) {
        const auto model = make_model(design.experiment);
        const State chosen = carried(study.model(), selection.chosen.fitted.state, *model);
        const State rival = carried(study.model(), draw.fit.fitted.state, *model);
        const double nats = (expected_nats(*model, chosen, rival) + expected_nats(*model, rival, chosen)) / 2;
        out.push_back({design.what, bits_of(nats), {name(draw.chosen), name(draw.rival)}});
    }
    std::stable_sort(out.begin(), out.end(),
                     [](const Suggestion& a, const Suggestion& b) { return a.bits > b.bits; });
    if (out.size() > kMostSuggestions) out.resize(kMostSuggestions);
    // Where no design of the grid tells them apart, the catalogue's own advice stands alone.
    if (out.empty() || out.front().bits < 0.05)
        out.insert(out.begin(), {study.candidates()[draw.chosen].effect->separated_by,
                                 0.0,
                                 {name(draw.chosen), name(draw.rival)}});
    return out;
}

}  // namespace puckloop::gap
