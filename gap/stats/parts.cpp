#include "gap/stats/parts.h"

#include "gap/stats/exchange.h"
#include "gap/stats/series.h"

#include <algorithm>
#include <utility>

namespace puckloop::gap::stats {

namespace {

constexpr std::size_t kFolds = 6;
constexpr std::size_t kEnoughRuns = 3;
constexpr std::size_t kStretches = 12;  // of a run, where runs are few

/// Where each run stands when runs that are alike stand together; among themselves as in `order`.
std::vector<std::size_t> dealt(const std::vector<int>& runs, const std::vector<std::size_t>& order,
                               const std::vector<int>& likeness) {
    std::vector<std::size_t> place(runs.size());
    const auto by_kind = ordered(runs.size(), [&](std::size_t a, std::size_t b) {
        const int one = likeness[static_cast<std::size_t>(runs[a])],
                  other = likeness[static_cast<std::size_t>(runs[b])];
        return std::pair(one, order[a]) < std::pair(other, order[b]);
    });
    for (std::size_t k = 0; k < by_kind.size(); ++k)
        place[by_kind[k]] = k;
    return place;
}

}  // namespace

Parts parts_of(const std::vector<int>& run, std::uint64_t seed, const std::vector<int>& likeness) {
    const std::size_t n = run.size();
    Parts parts;
    std::vector<int> runs = run;
    std::ranges::sort(runs);
    runs.erase(std::unique(runs.begin(), runs.end()), runs.end());
    parts.fold.assign(n, 0);
    parts.block.assign(n, 0);
    const auto place = [&](int one) {
        return static_cast<std::size_t>(std::ranges::lower_bound(runs, one) - runs.begin());
    };
    if (runs.size() >= kEnoughRuns) {
        RandomStream random(seed, "gap/free form");
        std::vector<std::size_t> order = random_order(runs.size(), random);
        if (!likeness.empty()) order = dealt(runs, order, likeness);
        parts.folds = std::min(kFolds, runs.size());
        parts.blocks = runs.size();
        for (std::size_t i = 0; i < n; ++i) {
            parts.block[i] = static_cast<int>(place(run[i]));
            parts.fold[i] = static_cast<int>(order[place(run[i])] % parts.folds);
        }
        return parts;
    }
    parts.folds = kFolds;
    parts.blocks = runs.size() * kStretches;
    std::vector<std::size_t> length(runs.size(), 0), seen(runs.size(), 0);
    for (const int one : run)
        ++length[place(one)];
    for (std::size_t i = 0; i < n; ++i) {
        const std::size_t r = place(run[i]);
        const std::size_t stretch = seen[r]++ * kStretches / std::max<std::size_t>(length[r], 1);
        parts.block[i] = static_cast<int>(r * kStretches + stretch);
        parts.fold[i] = static_cast<int>(stretch % parts.folds);
    }
    return parts;
}

}  // namespace puckloop::gap::stats
