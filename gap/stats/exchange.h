#pragma once
// Which values may be exchanged when nothing but chance links a residual to a covariate.
//
// 1. Rows where either is missing are dropped.
// 2. A covariate that stands still for four rows or more on average (a distance at which 100 readings were
//    taken, a condition of a whole run) gives one value a stretch: 100 readings of one placement share its
//    error and count once. Of more than 3000 values, neighbours are averaged.
// 3. What remains is cut into blocks of 2.5 times the correlation length (of y less its line on x). They are
//    exchanged inside their run if the covariate varies mostly inside runs and at least five blocks more
//    than runs are there (each run's mean is then taken off); over all runs otherwise.
// 4. A covariate that varies both ways, mostly between runs, gives one value a run.
// p: (hits + 1) / (permutations + 1); with 20 units or more and few hits a gamma distribution with the first
// three moments of the permuted statistics carries the tail farther, over five times the permutations where p
// is near what is decided by. A test ends early at 20 hits.

#include "base/random.h"
#include "gap/stats/finding.h"
#include "gap/stats/series.h"

#include <functional>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

namespace puckloop::gap::stats {

/// Rows cut into stretches: a new one where the run changes or `begins(row)`.
template <class Run, class Begins = bool (*)(std::size_t)>
std::vector<Stretch> stretches_of(
    const std::vector<Run>& run, const Begins& begins = [](std::size_t) { return false; }) {
    std::vector<Stretch> stretches;
    for (std::size_t i = 0; i < run.size(); ++i) {
        if (i == 0 || run[i] != run[i - 1] || begins(i))
            stretches.push_back({i, i, static_cast<int>(run[i])});
        stretches.back().last = i + 1;
    }
    return stretches;
}

/// Every order of `values` alike (Fisher and Yates, from the last one down).
template <class T>
void shuffle(std::span<T> values, RandomStream& random) {
    for (std::size_t i = values.size(); i > 1; --i)
        std::swap(values[i - 1], values[random.below(i)]);
}

/// 0 .. count - 1 in any order.
std::vector<std::size_t> random_order(std::size_t count, RandomStream& random);

/// A covariate and a residual, ready to be tested: rows are units that count.
struct Pairs {
    std::vector<double> x, y;
    std::vector<int> group;       ///< exchange stays inside a group; rows of a group stand together
    std::vector<Stretch> blocks;  ///< what is exchanged as a whole

    std::size_t size() const { return x.size(); }
};

/// The rows in which both are known, group by run.
Pairs known_pairs(const Series& residual, const std::vector<double>& covariate);

Pairs prepared(const Series& residual, const std::vector<double>& covariate);

/// `statistic` of the permuted y (large = structure). Returns p of the unpermuted one.
double permutation_p(const Pairs& pairs, const std::function<double(const std::vector<double>& y)>& statistic,
                     const TestOptions& options, std::string_view stream);

/// P(X > observed) of a gamma distribution (Pearson III) with the mean, spread and skewness of `null`;
/// at least 1e-12.
double fitted_tail(const std::vector<double>& null, double observed);

/// Is p so near the bounds that things are decided by (1e-4 after correction) that the chance of the draws
/// could decide? Then so many times as many are drawn.
bool in_doubt(double p);
inline constexpr int kDrawsInDoubt = 5;

/// The same for any way to draw a null value of the statistic.
double null_p(double observed, double units, const std::function<double(RandomStream&)>& draw,
              const TestOptions& options, std::string_view stream);

/// Units below which a test against a covariate is not asked.
inline constexpr std::size_t kLeastUnits = 5;
/// The finding of such a test that is not asked.
Finding too_few(Finding finding, const Pairs& pairs);
/// Size of an effect over the residual's robust scale; 0 where there is none.
double beside_scatter(double effect, const Series& residual);

/// Least squares of y on x; 0 where x does not vary.
double slope_of(const Pairs& pairs);

/// Without the rows that have no value.
Series without_gaps(const Series& residual);

}  // namespace puckloop::gap::stats
