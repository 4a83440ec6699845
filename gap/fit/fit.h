#pragma once
// Maximum posterior fit of a model's freed parameters together with the noise of its observables (Ceres).

#include "gap/fit/likelihood.h"
#include "gap/models/model.h"

#include <vector>

namespace puckloop::gap {

/// A model parameter that a fit may change. Weak prior about the neutral value (objective.h).
struct Freed {
    std::size_t index = 0;  ///< in Model::parameters()
    double low = 0.0, high = 0.0, prior_sd = 1.0, centre = 0.0;
    double resolution = 0.0;  ///< no interval is narrower than this to either side
    bool threshold = false;   ///< moves no row until it meets something that was tried
    double possible = 0.0;    ///< within this factor of neutral; 0: anything
};

/// Where a fit starts and where it ended.
struct State {
    std::vector<double> values;          ///< as Model::parameters()
    std::vector<NoiseParameters> noise;  ///< an observable each
};

/// A weight a row, an observable each; empty: all 1.
using Weights = std::vector<std::vector<double>>;
inline const Weights kEven{};

struct Fitted {
    State state;
    double log_likelihood = 0.0;  ///< weighted sum over rows
};

State neutral_state(const Model& model);

/// How thorough a fit is.
struct Effort {
    int iterations = 40;  ///< of the solver
    bool noise = true;    ///< false: of the noise only its size is fitted, and no nuisance of the model
    bool wander = true;   ///< false: what lets sums wander is left as it is
};
inline constexpr Effort kThorough{}, kQuick{.iterations = 6}, kPart{.iterations = 6, .noise = false},
    kGlance{.iterations = 2};
/// Of what is reported of runs that had no part in it: everything is fitted to the others, noise and
/// nuisances as well, so that where the fit to all rows ended is a start and no more.
inline constexpr Effort kHeldOut{.iterations = 12};

Fitted fit(const Model& model, const std::vector<Freed>& freed, const State& start, const Weights& weights,
           const Effort& effort = kThorough);

/// log likelihood of all rows, with what the noise loses for being off the simulator's claim.
double log_likelihood(const Model& model, const State& state);
/// Everything about the rows at a state, by what the model predicts there.
std::vector<RowCosts> costs_at(const Model& model, const State& state, const Prediction& prediction);
/// The sum of what all rows cost, nats.
double cost_of(const Model& model, const State& state, const Prediction& prediction);

}  // namespace puckloop::gap
