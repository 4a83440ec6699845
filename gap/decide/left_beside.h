#pragma once
// Goodness of fit, cause by cause. A strong cause of one observable must not carry a weak one of another into
// the verdict: each has to explain most of what is wrong where it acts.

#include "gap/findings/findings.h"
#include "gap/fit/select.h"

#include <vector>

namespace puckloop::gap {

/// The weakest of the chosen effects, if any, beside which more than `share` is left (of what moves no sum a
/// fifth at most), of what they gained when they were taken and what is left together, in the observables
/// that they move: by functions of covariates, or as the surest structure there may stand for.
std::vector<std::size_t> outweighed(const Study& study, const Selection& selection,
                                    const std::vector<FreeForm>& forms,
                                    const std::vector<Leftover>& leftovers, double share);

}  // namespace puckloop::gap
