#include "campaigns/statistics/ranks.h"

#include <algorithm>
#include <numeric>

namespace puckloop::statistics {

namespace {

/// Calls `take(order, begin, end)` for each group of equal values.
template <typename Take>
void for_ties(std::span<const double> values, Take take) {
    std::vector<std::size_t> order(values.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(),
                     [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
    for (std::size_t begin = 0, end = 0; begin < order.size(); begin = end) {
        while (end < order.size() && values[order[end]] == values[order[begin]])
            ++end;
        take(order, begin, end);
    }
}

}  // namespace

std::vector<double> midranks(std::span<const double> values) {
    std::vector<double> ranks(values.size());
    for_ties(values, [&](const std::vector<std::size_t>& order, std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
            ranks[order[i]] = static_cast<double>(begin + end + 1) / 2.0;
    });
    return ranks;
}

double tie_sum(std::span<const double> values) {
    double sum = 0.0;
    for_ties(values, [&](const std::vector<std::size_t>&, std::size_t begin, std::size_t end) {
        const auto ties = static_cast<double>(end - begin);
        sum += ties * ties * ties - ties;
    });
    return sum;
}

}  // namespace puckloop::statistics
