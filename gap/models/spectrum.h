#pragma once
// Looking for one spectral line in residuals: only to begin a fit near it.

#include "gap/models/model.h"

namespace puckloop::gap {

struct Line {
    double frequency = 0.0;  ///< Hz; 0: none can be looked for
    double power = 0.0;      ///< comparable between time axes of the same rows
};

/// The strongest line in the differences of y - mean, chains summed. Looks up to `highest` (Hz; 0: half the
/// usual rate of rows).
Line strongest_line(const Observable& observable, const std::vector<double>& mean, double highest = 0.0);

}  // namespace puckloop::gap
