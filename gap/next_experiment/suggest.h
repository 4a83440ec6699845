#pragma once
// The next experiment: the one whose outcome the remaining rivals disagree about most.

#include "gap/findings/findings.h"
#include "gap/fit/select.h"

#include <string>
#include <vector>

namespace puckloop::gap {

/// An experiment and the mean of the log likelihood ratio between two rivals that it promises.
struct Worth {
    std::string what;
    double nats = 0.0;
};

/// Best first, at most five. What separates nothing is left out, and so is what promises the same as one
/// before it, within a percent: neither rival minds what is different about it. Those that differ by less
/// than is printed have one rank.
std::vector<Suggestion> ranked(const std::vector<Worth>& worths);

/// For each pair of draws: what the catalogue proposes, with the information it would give, best first.
std::vector<Suggestion> suggestions_for(const Study& study, const Selection& selection);

/// For effects that the data at hand cannot identify: what would separate each, of one prior width, from
/// nothing. `none`: the fit without them.
std::vector<Suggestion> identifying(const Study& study, const Fit& none,
                                    const std::vector<std::size_t>& effects);

}  // namespace puckloop::gap
