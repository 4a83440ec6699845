#pragma once
// Looking for one spectral line in residuals: only to begin a fit near it.

#include "gap/models/model.h"

namespace puckloop::gap {

/// Frequency (Hz) of the strongest line in the differences of y - mean, chains summed; empty without times.
std::vector<double> strongest_line(const Observable& observable, const std::vector<double>& mean);

}  // namespace puckloop::gap
