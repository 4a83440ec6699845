#include "gap/next_experiment/suggest.h"

#include "gap/next_experiment/designs.h"
#include "gap/stats/series.h"
#include "physics/description/robot_constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

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

std::vector<Suggestion> ranked(const std::vector<Worth>& worths) {
    constexpr double kSame = 0.01;    // share: neither rival minds what is different
    constexpr double kEqual = 0.005;  // bits: no difference in what is printed
    const auto size = [&](std::size_t i) { return std::isnan(worths[i].nats) ? 0.0 : worths[i].nats; };
    std::vector<Suggestion> out;
    std::size_t simplest = 0;  // of those that promise the same as the last one taken
    double nats = 0.0;         // of the best of these
    for (const std::size_t i :
         stats::ordered(worths.size(), [&](std::size_t a, std::size_t b) { return size(a) > size(b); })) {
        const double bits = bits_of(worths[i].nats);
        if (!(bits >= kLeastBits)) continue;
        if (!out.empty() && worths[i].nats > nats * (1 - kSame)) {
            simplest = std::min(simplest, i);  // the simpler ones come first in the grid
            out.back().what = worths[simplest].what;
            continue;
        }
        if (out.size() == kMostSuggestions) break;
        const bool equal = !out.empty() && out.back().bits - bits < kEqual;
        const int rank = equal ? out.back().rank : static_cast<int>(out.size()) + 1;
        out.push_back({worths[i].what, bits, {}, rank});
        simplest = i;
        nats = worths[i].nats;
    }
    return out;
}

namespace {

/// Each design's worth between two states, both ways round; done as often as the longest of them takes: what
/// only has more rows separates no better.
template <class States>
std::vector<Worth> worths_of(const std::vector<Design>& designs, const States& states) {
    std::size_t rows = 0;
    for (const Design& design : designs)
        rows = std::max(rows, design.experiment.rows());
    std::vector<Worth> worths;
    for (const Design& design : designs) {
        const auto model = make_model(design.experiment);
        const auto [one, other] = states(*model);
        const double nats = (expected_nats(*model, one, other) + expected_nats(*model, other, one)) / 2;
        worths.push_back(
            {design.what, nats * static_cast<double>(rows) / static_cast<double>(design.experiment.rows())});
    }
    return worths;
}

/// Do drives of the grid, which are in steps a second, suit this robot?
bool is_like_e_puck(const Experiment& experiment) {
    constexpr double kAlike = 3.0;
    const double step = experiment.nominal_or("robot.wheel_radius_left", physics::kWheelRadius) /
                        physics::kWheelRadius * physics::kStepsPerTurn /
                        experiment.nominal_or("robot.steps_per_turn", physics::kStepsPerTurn);
    return step < kAlike && step > 1 / kAlike;
}

/// The best of them; where no design of the grid is worth anything, the catalogue's own advice.
std::vector<Suggestion> advised(const std::vector<Worth>& worths, const Effect& effect,
                                const std::vector<std::string>& between) {
    std::vector<Suggestion> out = ranked(worths);
    if (out.empty()) out.push_back({effect.separated_by, NAN, {}});
    for (Suggestion& one : out)
        one.between = between;
    return out;
}

}  // namespace

std::vector<Suggestion> suggestions_for(const Study& study, const Selection& selection) {
    if (selection.draws.empty()) return {};
    const Draw& draw = selection.draws.front();
    const Effect &chosen = *study.candidates()[draw.chosen].effect,
                 &rival = *study.candidates()[draw.rival].effect;
    const auto worths = worths_of(designs_of(study.experiment()), [&](const Model& model) {
        return std::pair(carried(study.model(), selection.chosen.fitted.state, model),
                         carried(study.model(), draw.fit.fitted.state, model));
    });
    return advised(worths, chosen, {chosen.name, rival.name});
}

std::vector<Suggestion> identifying(const Study& study, const Fit& none,
                                    const std::vector<std::size_t>& effects) {
    std::vector<Suggestion> out;
    const std::vector<Design> designs = designs_of(study.experiment());
    for (const std::size_t effect : effects) {
        const Candidate& candidate = study.candidates()[effect];
        std::vector<Worth> worths;
        if (is_like_e_puck(study.experiment()))
            worths = worths_of(designs, [&](const Model& model) {
                const State without = carried(study.model(), none.fitted.state, model);
                State with = without;
                for (const Freed& freed : candidate.freed)
                    if (const auto index = model.find(study.model().parameters()[freed.index].name))
                        with.values[*index] =
                            std::clamp(freed.centre + freed.prior_sd, freed.low, freed.high);
                return std::pair(with, without);
            });
        const auto best = advised(worths, *candidate.effect, {candidate.effect->name, "nothing"}).front();
        if (std::ranges::none_of(out, [&](const Suggestion& one) { return one.what == best.what; }))
            out.push_back(best);
    }
    return out;
}

}  // namespace puckloop::gap
