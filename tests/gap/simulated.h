#pragma once
// An experiment as the simulator has it: every observable row by row.

#include "gap/diagnostics/series.h"
#include "gap/fit/fit.h"
#include "gap/models/model.h"

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap::test {

/// Runs of so many rows each: `row_of(run, r, k)` writes row k of run r, in order.
template <class RowOf>
Experiment recorded(Kind kind, int runs, int rows, const RowOf& row_of) {
    Experiment experiment;
    experiment.kind = kind;
    for (int r = 0; r < runs; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        run.rows = static_cast<std::size_t>(rows);
        for (int k = 0; k < rows; ++k)
            row_of(run, r, k);
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

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
