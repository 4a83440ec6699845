#include "gap/evidence/criterion.h"

#include "gap/evidence/thresholds.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

Gain gain_of(const std::vector<double>& by_block) {
    Gain gain;
    const auto n = static_cast<double>(by_block.size());
    for (const double one : by_block) {
        gain.sum += one;
        gain.share_better += one > 0 ? 1 / n : 0;
        gain.clearly_better += one > kClearGain ? 1 : 0;
        gain.clearly_worse += one < -kClearGain ? 1 : 0;
    }
    double squares = 0.0;
    for (const double one : by_block)
        squares += (one - gain.sum / n) * (one - gain.sum / n);
    gain.sd = n > 1 ? std::sqrt(squares * n / (n - 1)) : INFINITY;
    gain.without_best = by_block.empty() ? 0.0 : gain.sum - *std::ranges::max_element(by_block);
    return gain;
}

double needed_gain(std::size_t candidates, std::size_t taken) {
    const auto n = static_cast<double>(std::max(candidates, taken)), k = static_cast<double>(taken);
    return std::lgamma(n + 1) - std::lgamma(k + 1) - std::lgamma(n - k + 1) -
           std::log(thresholds::kFalseAlarm);
}

bool gains_enough(const Gain& gain, std::size_t candidates, std::size_t taken) {
    const double needed = needed_gain(candidates, taken);
    return gain.sum > needed && (gain.sum > thresholds::kStandardErrors * gain.sd || gain.in_several(needed));
}

}  // namespace puckloop::gap
