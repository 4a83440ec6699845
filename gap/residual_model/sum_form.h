#pragma once
// The free-form residual model of a sum: what it gains in rows of some kind, each by itself or in proportion
// to the way or the turn made there, that no named effect tells. Where free_form.h looks at single rows, this
// follows what they add up to.

#include "gap/data/experiment.h"
#include "gap/findings/findings.h"
#include "gap/fit/fit.h"
#include "gap/stats/boosting.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

/// Of observable `o` of kind Level. `cells` as free_form_cells() of its rows.
FreeForm sum_form_of(const Experiment& experiment, const Model& model, const State& state,
                     const Prediction& prediction, std::size_t o, std::vector<stats::Component> cells,
                     std::uint64_t seed);

}  // namespace puckloop::gap
