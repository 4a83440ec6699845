#pragma once
// Fit and select: the set of causes as the search left it, with what the measuring chain always adds fitted
// along.

#include "gap/fit/select.h"
#include "gap/fit/study.h"

namespace puckloop::gap {

struct Chosen {
    Selection selection;
    Fit final;  ///< the chosen set with nuisances
};

/// Fits along tracker offset, tracker delay and sensor age, where the data tells them from the chosen set.
Chosen chosen_of(const Study& study, Selection selection);

}  // namespace puckloop::gap
