#pragma once
// What rows cost that a term was not learnt from: minus the log density by which it predicts them, of what is
// not known of its tables as well. A run that goes where no other went is predicted by the prior.

#include "gap/extension/learn.h"

#include <vector>

namespace puckloop::gap {

/// Of each row that is not `used`, beside those of its run before it; 0 of the others. `with_term`: else by
/// the law of errors alone.
std::vector<double> held_costs(const Subject& subject, const std::vector<char>& used, const Learnt& learnt,
                               bool with_term);

}  // namespace puckloop::gap
