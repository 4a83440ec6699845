#pragma once
// The rival of every cause that makes single errors large: errors of which a few are larger, nothing said of
// when or which way (the contaminated normal law; Tukey 1960, "A survey of sampling from contaminated
// distributions").

#include "gap/fit/study.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// Log score of each block by the observables `touched`. Errors of `fit`, but for those that its causes make,
/// follow such a law, fitted to the other blocks, wherever that gains over the Student t of its noise.
std::vector<double> scores_with_large_errors(const Study& study, const Fit& fit,
                                             const std::vector<std::string>& touched);

}  // namespace puckloop::gap
