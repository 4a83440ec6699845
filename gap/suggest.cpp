#include "gap/suggest.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace puckloop::gap {

namespace {

constexpr double kMostBits = 1.0;  // two equally likely rivals

/// Expected information about which of two equally likely models is true when their predictions lie
/// `deviations` apart in units of the noise (binary channel with normal noise, to 0.02 bits).
double bits_of(double deviations) {
    return kMostBits * (1 - std::exp(-0.18 * deviations * deviations));
}

}  // namespace

std::vector<Suggestion> suggestions_for(const Study& study, const Selection& selection) {
    std::vector<Suggestion> out;
    (void)study;
    (void)selection;
    (void)bits_of;
    return out;
}

}  // namespace puckloop::gap
