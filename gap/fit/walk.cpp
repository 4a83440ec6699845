#include "gap/fit/walk.h"

#include "gap/stats/tails.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr double kLeastDensity = 1e-300;
constexpr double kNoTail = 1e9;      // degrees of freedom: a push is normal, whatever errors are
constexpr double kForgotten = 1e-4;  // of the likeliest history's weight

}  // namespace

void PushedWalk::begin(double value, double guess, double unsure, const Lever* lever) {
    Walk first{};
    first.begin(value, guess, unsure);
    levered_ = lever != nullptr;
    kept_[0] = {first, levered_ ? *lever : Lever{}, 1.0, 0};
    count_ = 1;
}

PushedWalk::Row PushedWalk::filter(double value, double arm, double drift, double memory, double tail,
                                   const Push& push) {
    const bool possible = push.chance > 0 && push.variance > 0;
    if (tail != tail_) {
        tail_ = tail;
        normal_ = stats::normal_density(0.0) / std::exp(stats::StudentLaw(tail).log_height());
    }
    double likely = 0.0, innovations = 0.0, off = 0.0, best = 0.0;
    std::size_t next = 0;
    std::array<std::size_t, 2 * kHistories>
        order;  // the likeliest first, those that came first before others
    const auto go_on = [&](const History& old, bool pushed) {
        History& history = next_[next];
        history = old;
        history.pushed = old.pushed << 1U | (pushed ? 1U : 0U);
        if (push.variance > 0) history.weight *= pushed ? push.chance : 1 - push.chance;
        if (pushed) history.walk.level += push.mean;
        double innovation = 0.0;
        const double gained = drift + (pushed ? push.variance : 0.0), law = pushed ? kNoTail : tail;
        const double variance =
            levered_ ? history.walk.filter(value, arm, history.lever, gained, memory, law, innovation)
                     : history.walk.filter(value, gained, memory, law, innovation);
        const double root = std::sqrt(variance), z = innovation / root;
        if (!pushed) off += old.weight * innovation;
        history.weight *= (pushed ? normal_ * std::exp(-z * z / 2)
                                  : std::exp(-(tail + 1) / 2 * std::log(1 + z * z / tail))) /
                          root;
        likely += history.weight;
        innovations += history.weight * z;
        best = std::max(best, history.weight);
        std::size_t place = next++;
        for (; place > 0 && next_[order[place - 1]].weight < history.weight; --place)
            order[place] = order[place - 1];
        order[place] = next - 1;
    };
    for (std::size_t k = 0; k < count_; ++k)
        go_on(kept_[k], false);
    // Wherever a push may have led: it is no likelier than this.
    const double most = possible ? push.chance * normal_ / std::sqrt(push.variance) : 0.0;
    for (std::size_t k = 0; k < count_; ++k)
        if (kept_[k].weight * most > kForgotten * best) go_on(kept_[k], true);
    count_ = std::min(next, kHistories);
    while (count_ > 1 && next_[order[count_ - 1]].weight < kForgotten * next_[order[0]].weight)
        --count_;
    double sum = 0.0;
    for (std::size_t k = 0; k < count_; ++k)
        sum += next_[order[k]].weight;
    for (std::size_t k = 0; k < count_; ++k) {
        kept_[k] = next_[order[k]];
        kept_[k].weight = sum > 0 ? kept_[k].weight / sum : 1.0 / static_cast<double>(count_);
    }
    likely = std::max(likely, kLeastDensity);
    return {-std::log(likely), innovations / likely, off};
}

double PushedWalk::pushed(unsigned back) const {
    double sum = 0.0;
    for (std::size_t k = 0; k < count_; ++k)
        if ((kept_[k].pushed >> back & 1U) != 0) sum += kept_[k].weight;
    return sum;
}

}  // namespace puckloop::gap
