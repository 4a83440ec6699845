#include "gap/fit/walk.h"

#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kLeastDensity = 1e-300;
constexpr std::size_t kHistories = 5;
constexpr double kNoTail = 1e9;      // degrees of freedom: a push is normal, whatever errors are
constexpr double kForgotten = 1e-4;  // of the likeliest history's weight

}  // namespace

void PushedWalk::begin(double value, double guess, double unsure, const Lever& lever) {
    Walk first{};
    first.begin(value, guess, unsure);
    kept_.assign(1, {first, lever, 1.0, 0});
}

PushedWalk::Row PushedWalk::filter(double value, double arm, double drift, double memory, double tail,
                                   const Push& push) {
    const bool possible = push.chance > 0 && push.variance > 0;
    if (tail != tail_) {
        tail_ = tail;
        normal_ = stats::normal_density(0.0) / std::exp(stats::StudentLaw(tail).log_height());
    }
    next_.clear();
    double likely = 0.0, innovations = 0.0, off = 0.0, best = 0.0;
    const auto go_on = [&](const History& old, bool pushed) {
        History history = old;
        history.pushed = old.pushed << 1U | (pushed ? 1U : 0U);
        if (push.variance > 0) history.weight *= pushed ? push.chance : 1 - push.chance;
        if (pushed) history.walk.level += push.mean;
        double innovation = 0.0;
        const double variance =
            history.walk.filter(value, arm, history.lever, drift + (pushed ? push.variance : 0.0), memory,
                                pushed ? kNoTail : tail, innovation);
        const double z = innovation / std::sqrt(variance);
        if (!pushed) off += old.weight * innovation;
        history.weight *= (pushed ? normal_ * std::exp(-z * z / 2)
                                  : std::exp(-(tail + 1) / 2 * std::log(1 + z * z / tail))) /
                          std::sqrt(variance);
        likely += history.weight;
        innovations += history.weight * z;
        best = std::max(best, history.weight);
        next_.push_back(history);
    };
    for (const History& old : kept_)
        go_on(old, false);
    // Wherever a push may have led: it is no likelier than this.
    const double most = possible ? push.chance * normal_ / std::sqrt(push.variance) : 0.0;
    for (const History& old : kept_)
        if (old.weight * most > kForgotten * best) go_on(old, true);
    std::ranges::sort(next_, std::ranges::greater{}, &History::weight);
    if (next_.size() > kHistories) next_.resize(kHistories);
    while (next_.size() > 1 && next_.back().weight < kForgotten * next_.front().weight)
        next_.pop_back();
    double sum = 0.0;
    for (const History& history : next_)
        sum += history.weight;
    std::swap(kept_, next_);
    for (History& history : kept_)
        history.weight = sum > 0 ? history.weight / sum : 1.0 / static_cast<double>(kept_.size());
    likely = std::max(likely, kLeastDensity);
    return {-std::log(likely), innovations / likely, off};
}

double PushedWalk::pushed(unsigned back) const {
    double sum = 0.0;
    for (const History& history : kept_)
        if ((history.pushed >> back & 1U) != 0) sum += history.weight;
    return sum;
}

}  // namespace puckloop::gap
