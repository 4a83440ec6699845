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

/// Fills a column by what the simulator gives for each row, in order: `measured(simulated, run, row)`.
template <class Measured>
void fill(Experiment& experiment, const char* column, const Measured& measured) {
    const Series series = simulated(experiment).front();
    for (std::size_t i = 0; i < series.before.size(); ++i)
        experiment.runs[series.run[i]].columns[column][series.row[i]] =
            measured(series.before[i], series.run[i], series.row[i]);
}

}  // namespace puckloop::gap::test
