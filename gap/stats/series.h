#pragma once
// Residuals as the tests take them: values in order of time inside each run, with the run each belongs to.
// How much they depend on each other decides how many of them count.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

namespace puckloop::gap::stats {

/// One observable's residuals. Rows of a run stand together, in order of time.
struct Series {
    std::vector<double> value;
    std::vector<int> run;
    /// What happens or not: rare events are all there is to see, no wild values, and the rank of a row says
    /// how likely it was more than what came of it.
    bool events = false;

    std::size_t size() const { return value.size(); }
};

/// Half-open stretches [first, last) of rows of one run.
struct Stretch {
    std::size_t first = 0, last = 0;
    int run = 0;

    std::size_t size() const { return last - first; }
};

/// Lowest and highest known value; the other way round where none is. NaN is not known.
struct Range {
    double low = INFINITY, high = -INFINITY;

    void take(const std::vector<double>& values);
    bool empty() const { return !(low <= high); }
};

/// Do the known values differ?
bool varies(const std::vector<double>& values);

/// By how much each value differs from the one before; left out where either is not known.
std::vector<double> steps_of(const std::vector<double>& values);

/// Is `one` in the list?
template <class List, class One>
bool contains(const List& list, const One& one) {
    return std::ranges::find(list, one) != std::ranges::end(list);
}

/// 0 .. count - 1, in the order of `less`; what is alike stays as it is.
template <class Less>
std::vector<std::size_t> ordered(std::size_t count, const Less& less) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::stable_sort(order, less);
    return order;
}

/// Values as a test of the series takes them: wild ones pulled in (robust.h), events as they are.
std::vector<double> pulled_in(const Series& series, const std::vector<double>& values);

std::vector<Stretch> runs_of(const std::vector<int>& run);

/// Autocorrelation at 1..longest rows, pooled over runs, each about its own mean.
std::vector<double> autocorrelation(const Series& series, std::size_t longest);

/// Rows that one independent value is worth: 1 + 2 * sum of the autocorrelations up to the first that
/// vanishes in its own noise. At least 1.
double correlation_length(const Series& series);

/// Block length for resampling: 2.5 times the correlation length, at most a third of the longest run.
std::size_t block_length(const Series& series);

/// Runs cut into blocks of about `length` rows (the last of a run may be shorter, never below half).
std::vector<Stretch> blocks_of(const std::vector<int>& run, std::size_t length);

}  // namespace puckloop::gap::stats
