#pragma once
// A small grid of experiments of each kind that a laboratory could do next, as tables without measurements.

#include "gap/data/experiment.h"

#include <string>
#include <vector>

namespace puckloop::gap {

struct Design {
    std::string what;       ///< in plain words
    Experiment experiment;  ///< the nominal numbers of the one at hand; observables are placeholders
};

std::vector<Design> designs_of(const Experiment& like);

}  // namespace puckloop::gap
