#pragma once
// Fit and select: the set of causes as the search left it, with what the measuring chain always adds fitted
// along; and the same with some of them gone again.

#include "gap/fit/select.h"
#include "gap/fit/study.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::gap {

struct Chosen {
    Selection selection;
    Fit final;  ///< the chosen set with nuisances
};

/// Fits along tracker offset, tracker delay and sensor age, where the data tells them from the chosen set.
Chosen chosen_of(const Study& study, Selection selection);

/// Without effects that are doubted by themselves. None: one of them is the first, which the others were
/// built on, or the first would have to go for saying too little alone.
std::optional<Chosen> without_doubted(const Study& study, const Selection& all,
                                      const std::vector<std::size_t>& doubted, const std::string& doubt);

/// Without any: an effect fitted to what it does not describe soaks up some of it and leaves much.
Chosen taken_back(const Chosen& all, const std::string& doubt);

}  // namespace puckloop::gap
