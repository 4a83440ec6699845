#include "gap/predictive/check.h"

#include "gap/fit/likelihood.h"
#include "gap/fit/parallel.h"
#include "gap/predictive/discrepancies.h"
#include "gap/predictive/posterior.h"
#include "gap/predictive/replicate.h"
#include "gap/residuals/main_covariates.h"
#include "gap/residuals/residual_structure.h"
#include "gap/stats/exchange.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr std::size_t kReplicates = 199, kFewer = 99;  // of many rows: each costs a prediction and a filter
constexpr std::size_t kManyCheckedRows = 20000;

/// Measured minus shown, both as far as the instrument reaches; of a sum what each row adds, in the
/// observable's unit.
std::vector<double> residuals_of(const Observable& o, const Predicted& at_fit, const NoiseParameters& noise) {
    std::vector<double> residuals(o.y.size());
    if (adds_up(o)) {
        Innovations innovations;
        filter(o, at_fit, noise, innovations);
        for (std::size_t i = 0; i < residuals.size(); ++i)
            residuals[i] = innovations.role[i] == RowRole::Plain
                               ? innovations.z[i] * std::sqrt(innovations.variance[i])
                               : NAN;
    } else {
        for (std::size_t i = 0; i < residuals.size(); ++i)
            residuals[i] = o.instrument.clipped(o.y[i]) - o.instrument.clipped(shown(at_fit, i));
    }
    return residuals;
}

std::vector<stats::Covariate> covariates_for(const Experiment& experiment, const Observable& o) {
    Series rows;
    rows.run = o.run;
    rows.row = o.row;
    return main_covariates(experiment, o.name, covariates_of(experiment, rows), o.row);
}

}  // namespace

std::vector<PredictiveCheck> predictive_checks(const Study& study, const Fit& fit, bool extended,
                                               std::uint64_t seed) {
    const Model& model = study.model();
    const auto& observables = model.observables();
    const State& mode = fit.fitted.state;
    const Prediction at_fit = model.predicted(mode.values);
    std::vector<std::vector<Discrepancy>> discrepancies;
    for (std::size_t o = 0; o < observables.size(); ++o)
        discrepancies.push_back(
            discrepancies_of(observables[o], residuals_of(observables[o], at_fit[o], mode.noise[o]),
                             covariates_for(study.experiment(), observables[o]),
                             adds_up(observables[o]) ? "added by a row" : "measured − simulated"));
    RandomStream random(seed, fmt::format("gap/posterior {}", extended));
    const auto replicate_until = [&](std::size_t count) {
        const std::size_t so_far = discrepancies.front().front().replicated.size();
        const auto states = posterior_states(model, fit.freed, mode, count - so_far, random);
        for (auto& of_observable : discrepancies)
            for (Discrepancy& one : of_observable)
                one.replicated.resize(count);
        in_parallel(states.size(), study.threads(), [&](std::size_t k) {
            RandomStream own(seed, fmt::format("gap/replicate {} {}", extended, so_far + k));
            const Prediction drawn = model.predicted(states[k].values);
            for (std::size_t o = 0; o < observables.size(); ++o) {
                Observable replicate = observables[o];
                replicate.y = replicated(observables[o], drawn[o], states[k].noise[o], own);
                const auto residuals = residuals_of(replicate, at_fit[o], mode.noise[o]);
                for (Discrepancy& one : discrepancies[o])
                    one.replicated[so_far + k] = one.values_of(residuals);
            }
        });
        std::vector<PredictiveCheck> checks;
        for (std::size_t o = 0; o < observables.size(); ++o) {
            checks.push_back(
                {observables[o].name, observables[o].unit, extended, static_cast<int>(count), {}});
            for (const Discrepancy& one : discrepancies[o])
                checks.back().curves.push_back(one.judged());
        }
        return checks;
    };
    const std::size_t count = study.rows() > kManyCheckedRows ? kFewer : kReplicates;
    auto checks = replicate_until(count);
    const bool doubtful = std::ranges::any_of(checks, [](const PredictiveCheck& check) {
        return std::ranges::any_of(
            check.curves, [](const auto& curve) { return curve.counts && stats::in_doubt(curve.tail); });
    });
    return doubtful ? replicate_until(stats::kDrawsInDoubt * count) : checks;
}

}  // namespace puckloop::gap
