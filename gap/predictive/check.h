#pragma once
// Posterior-predictive checks of a fit: data replicated from it against what was measured, by discrepancies
// declared beforehand. The discrepancies know no effect.

#include "gap/findings/predictive.h"
#include "gap/fit/study.h"

#include <cstdint>
#include <vector>

namespace puckloop::gap {

/// A check of each observable. Residuals are measured minus simulated at the fit; of sums what each row adds
/// to what the rows before it foresee. The same for any number of the study's threads.
std::vector<PredictiveCheck> predictive_checks(const Study& study, const Fit& fit, bool extended,
                                               std::uint64_t seed);

}  // namespace puckloop::gap
