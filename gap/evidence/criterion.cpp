#include "gap/evidence/criterion.h"

#include "gap/decide/thresholds.h"
#include "gap/fit/study.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

double log_sets(std::size_t candidates, std::size_t taken) {
    const auto n = static_cast<double>(std::max(candidates, taken)), k = static_cast<double>(taken);
    return std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1);
}

double needed_gain(std::size_t candidates, std::size_t taken) {
    return log_sets(candidates, taken) - std::log(thresholds::kFalseAlarm);
}

bool gains_enough(const Gain& gain, std::size_t candidates, std::size_t taken) {
    return gain.sum > needed_gain(candidates, taken) && gain.sum > thresholds::kStandardErrors * gain.sd;
}

}  // namespace puckloop::gap
