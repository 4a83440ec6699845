#pragma once
// An experiment as the simulator has it: every observable row by row.

#include "gap/diagnostics/series.h"
#include "gap/fit/fit.h"
#include "gap/models/model.h"

#include <vector>

namespace puckloop::gap::test {

/// With the nominal numbers, in `before` and `after` alike.
inline std::vector<Series> simulated(const Experiment& experiment) {
    const auto model = make_model(experiment);
    const State nominal = neutral_state(*model);
    return series_of(*model, nominal, nominal);
}

}  // namespace puckloop::gap::test
