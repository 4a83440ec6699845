#pragma once
// Exchange at random, as permutation tests and deals into folds want it.

#include "base/random.h"

#include <cstddef>
#include <span>
#include <utility>

namespace puckloop::gap::stats {

/// Every order of `values` alike (Fisher and Yates, from the last one down).
template <class T>
void shuffle(std::span<T> values, RandomStream& random) {
    for (std::size_t i = values.size(); i > 1; --i)
        std::swap(values[i - 1], values[random.below(i)]);
}

}  // namespace puckloop::gap::stats
