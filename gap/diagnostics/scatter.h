#pragma once
// Effects that change no mean: they only make errors larger, rarer or more regular. A mean that the model
// lacks looks like them, for larger errors are all that a fit can make of it.

#include "gap/fit/study.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// The effects of a fit that move no prediction's mean.
std::vector<std::size_t> scatter_effects(const Study& study, const Fit& fit);

/// Names of the observables whose noise or chances differ by these effects of a fit.
std::vector<std::string> scattered_by(const Study& study, const Fit& fit,
                                      const std::vector<std::size_t>& effects);

/// Does the fit take single rows for lapses, each by a chance of its own?
bool lapses(const Study& study, const Fit& fit);

/// The fit's other effects, fitted again without them.
Fit without_effects(const Study& study, const Fit& fit, const std::vector<std::size_t>& dropped);

}  // namespace puckloop::gap
