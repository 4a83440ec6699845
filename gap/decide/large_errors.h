#pragma once
// The rival of every cause that makes single errors large: errors of which a few are larger, nothing said of
// when or which way (the contaminated normal law; Tukey 1960, "A survey of sampling from contaminated
// distributions").

#include "gap/fit/study.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// nats that held-out rows of the observables `touched` gain, block by block, when the errors of `fit` follow
/// such a law, fitted to the other blocks, in place of the Student t of its noise.
std::vector<double> gains_of_large_errors(const Study& study, const Fit& fit,
                                          const std::vector<std::string>& touched);

}  // namespace puckloop::gap
