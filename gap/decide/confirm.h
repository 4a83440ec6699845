#pragma once
// Confirm before naming: the causes are fitted on one half of the runs, the other half is corrected by what
// was found there and asked anew, as an experiment of its own. A cause that is one leaves nothing on runs
// that had no part in it.

#include "gap/decide/confirmation.h"
#include "gap/fit/select.h"
#include "gap/fit/study.h"

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace puckloop::gap {

/// What was found in an experiment: nats gained there by effects and by corrections without a mechanism.
struct Asked {
    bool nothing = true;
    double found = 0.0;
    std::string what;  ///< in words
};

/// Why the causes are not confirmed, in words that follow "but"; empty: they are, or there are too few runs
/// to ask. `ask` analyses half an experiment. `share_left` of what the correction gains there may be found
/// again.
std::string not_confirmed(const Study& study, const Selection& selection, double share_left,
                          const std::function<Asked(const Experiment&)>& ask);

/// The effects (candidates) that a half chooses by itself.
using ChooseOnHalf = std::function<std::vector<std::size_t>(const Experiment&)>;
Confirmation confirmation_of(const Study& study, const Selection& selection, const ChooseOnHalf& choose);

}  // namespace puckloop::gap
