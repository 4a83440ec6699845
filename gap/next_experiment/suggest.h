#pragma once
// The next experiment: the one whose outcome the remaining rivals disagree about most.

#include "gap/fit/select.h"
#include "gap/verdict/verdict.h"

#include <vector>

namespace puckloop::gap {

/// For each pair of draws: what the catalogue proposes, with the information it would give, best first.
std::vector<Suggestion> suggestions_for(const Study& study, const Selection& selection);

}  // namespace puckloop::gap
