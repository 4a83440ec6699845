#pragma once
// Parts of the rows to hold out in turn, and the blocks over which what is won there is judged.

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puckloop::gap::stats {

struct Parts {
    std::vector<int> fold, block;  ///< a row each
    std::size_t folds = 0, blocks = 0;
};

/// Six parts at most. Runs stay whole when there are three or more; else each is cut into stretches.
/// `likeness`: a number for each run, the same for runs that repeat each other (run i has the i-th; empty:
/// none do). Repeats are held out apart, so that what only they show can be learnt.
Parts parts_of(const std::vector<int>& run, std::uint64_t seed, const std::vector<int>& likeness = {});

}  // namespace puckloop::gap::stats
