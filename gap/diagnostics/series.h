#pragma once
// Measured, simulated before and after, and what is left: row by row, for tests, pictures and the verdict.

#include "gap/findings/findings.h"
#include "gap/fit/fit.h"

#include <vector>

namespace puckloop::gap {

/// An observable each, rows of a run in the order in which they were measured.
std::vector<Series> series_of(const Model& model, const State& before, const State& after);

}  // namespace puckloop::gap
