#include "gap/stats/exchange.h"

#include "gap/stats/robust.h"
#include "gap/stats/tails.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap::stats {

namespace {

constexpr std::size_t kStandsStill = 4;  // rows a plateau on average
constexpr double kLeastTail = 1e-12;
constexpr std::size_t kFreeBlocksForWithin = 5;  // blocks beyond one a run, to exchange inside runs
constexpr std::size_t kMostUnits = 3000;         // beyond, neighbours are averaged: time, not knowledge
constexpr int kHitsToStop = 20;                  // then p is known well enough
constexpr int kHitsForCount = 10;                // with fewer, the tail is carried on by a gamma distribution
constexpr double kUnitsForTail = 20;             // below, permutations are few and their tail is a staircase

/// One row a stretch: the means of x and y.
Pairs means_of(const Pairs& rows, const std::vector<Stretch>& stretches) {
    Pairs result;
    for (const Stretch& s : stretches) {
        double x = 0, y = 0;
        for (std::size_t i = s.first; i < s.last; ++i)
            x += rows.x[i], y += rows.y[i];
        result.x.push_back(x / static_cast<double>(s.size()));
        result.y.push_back(y / static_cast<double>(s.size()));
        result.group.push_back(s.run);
    }
    return result;
}

/// Share of the covariate's variance that lies between runs.
double share_between(const Pairs& rows, const std::vector<Stretch>& runs) {
    const Pairs means = means_of(rows, runs);
    const double all = mean(rows.x);
    double between = 0, total = 0;
    for (std::size_t r = 0; r < runs.size(); ++r)
        between += static_cast<double>(runs[r].size()) * (means.x[r] - all) * (means.x[r] - all);
    for (const double x : rows.x)
        total += (x - all) * (x - all);
    return total > 0 ? between / total : 0.0;
}

/// y less its straight line on x: the trend looked for must not pass for carry-over.
std::vector<double> without_line(const Pairs& rows) {
    const double slope =
        correlation(rows.x, rows.y) * standard_deviation(rows.y) / standard_deviation(rows.x);
    std::vector<double> rest = rows.y;
    if (std::isfinite(slope))
        for (std::size_t i = 0; i < rest.size(); ++i)
            rest[i] -= slope * rows.x[i];
    return rest;
}

void take_off_run_means(Pairs& pairs, const std::vector<Stretch>& runs) {
    const Pairs means = means_of(pairs, runs);
    const double all = mean(pairs.y);  // stays, so that "zero at zero" can be told
    for (std::size_t r = 0; r < runs.size(); ++r)
        for (std::size_t i = runs[r].first; i < runs[r].last; ++i)
            pairs.y[i] += all - means.y[r];
}

void shuffle_blocks(const Pairs& pairs, RandomStream& random, std::vector<double>& y) {
    std::vector<std::size_t> order(pairs.blocks.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t first = 0, last = 0; first < order.size(); first = last) {
        while (last < order.size() && pairs.blocks[last].run == pairs.blocks[first].run)
            ++last;
        shuffle(std::span(order).subspan(first, last - first), random);
    }
    std::size_t out = 0;
    for (const std::size_t b : order)
        for (std::size_t i = pairs.blocks[b].first; i < pairs.blocks[b].last; ++i)
            y[out++] = pairs.y[i];
}

}  // namespace

std::vector<std::size_t> random_order(std::size_t count, RandomStream& random) {
    std::vector<std::size_t> order(count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    shuffle(std::span(order), random);
    return order;
}

Pairs known_pairs(const Series& residual, const std::vector<double>& covariate) {
    Pairs rows;
    for (std::size_t i = 0; i < residual.size(); ++i)
        if (std::isfinite(residual.value[i]) && std::isfinite(covariate[i])) {
            rows.x.push_back(covariate[i]);
            rows.y.push_back(residual.value[i]);
            rows.group.push_back(residual.run[i]);
        }
    return rows;
}

Pairs prepared(const Series& residual, const std::vector<double>& covariate) {
    Pairs rows = known_pairs(residual, covariate);
    if (rows.size() == 0) return rows;
    const auto still = stretches_of(rows.group, [&](std::size_t i) { return rows.x[i] != rows.x[i - 1]; });
    if (still.size() * kStandsStill <= rows.size()) rows = means_of(rows, still);
    if (rows.size() > kMostUnits)
        rows = means_of(rows, blocks_of(rows.group, (rows.size() + kMostUnits - 1) / kMostUnits));
    std::vector<Stretch> runs = runs_of(rows.group);
    const double between = share_between(rows, runs);
    if (runs.size() < rows.size() && between > 0.5) {
        rows = means_of(rows, runs);
        runs = runs_of(rows.group);
    }
    const std::size_t length = block_length({without_line(rows), rows.group});
    rows.blocks = blocks_of(rows.group, length);
    if (rows.blocks.size() >= runs.size() + kFreeBlocksForWithin) {
        take_off_run_means(rows, runs);
    } else {
        std::ranges::fill(rows.group, 0);
        for (Stretch& b : rows.blocks)
            b.run = 0;
    }
    return rows;
}

double permutation_p(const Pairs& pairs, const std::function<double(const std::vector<double>&)>& statistic,
                     const TestOptions& options, std::string_view stream) {
    if (pairs.blocks.size() < 3) return 1.0;
    std::vector<double> y(pairs.size());
    const auto draw = [&](RandomStream& random) {
        shuffle_blocks(pairs, random, y);
        return statistic(y);
    };
    return null_p(statistic(pairs.y), static_cast<double>(pairs.blocks.size()), draw, options, stream);
}

double fitted_tail(const std::vector<double>& null, double observed) {
    const double centre = mean(null), spread = standard_deviation(null);
    if (!(spread > 0)) return kLeastTail;
    double third = 0;
    for (const double v : null)
        third += std::pow((v - centre) / spread, 3);
    const double skewness = third / static_cast<double>(null.size());
    const double z = (observed - centre) / spread;
    if (skewness < 0.05) return std::max(normal_tail(z), kLeastTail);
    const double shape = 4 / (skewness * skewness);
    return std::max(gamma_tail(shape, shape + z * std::sqrt(shape)), kLeastTail);
}

bool in_doubt(double p) {
    constexpr double kSurely = 1e-9, kHardly = 1e-3;
    return p > kSurely && p < kHardly;
}

double null_p(double observed, double units, const std::function<double(RandomStream&)>& draw,
              const TestOptions& options, std::string_view stream) {
    if (!std::isfinite(observed)) return 1.0;
    RandomStream random(options.seed, stream);
    const double nearly = observed - 1e-12 * std::fabs(observed);  // the same permutation, summed otherwise
    std::vector<double> null;
    int hits = 0;
    const auto p_of_draws = [&](int most) {
        while (static_cast<int>(null.size()) < most && hits < kHitsToStop) {
            null.push_back(draw(random));
            if (null.back() >= nearly) ++hits;
        }
        const double drawn = static_cast<double>(null.size());
        if (hits >= kHitsToStop) return hits / drawn;
        const double counted = (hits + 1) / (drawn + 1);
        if (hits >= kHitsForCount || units < kUnitsForTail) return counted;
        return std::min(counted, fitted_tail(null, observed));
    };
    const double p = p_of_draws(options.permutations);
    return in_doubt(p) ? p_of_draws(kDrawsInDoubt * options.permutations) : p;
}

Finding too_few(Finding finding, const Pairs& pairs) {
    return not_asked(std::move(finding), fmt::format("too few independent values ({})", pairs.size()));
}

double beside_scatter(double effect, const Series& residual) {
    const double scale = robust_scale(residual.value);
    return scale > 0 ? std::fabs(effect) / scale : 0.0;
}

double slope_of(const Pairs& pairs) {
    const double mean_x = mean(pairs.x), mean_y = mean(pairs.y);
    double square = 0, cross = 0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
        square += (pairs.x[i] - mean_x) * (pairs.x[i] - mean_x);
        cross += (pairs.x[i] - mean_x) * (pairs.y[i] - mean_y);
    }
    return square > 0 ? cross / square : 0.0;
}

Series without_gaps(const Series& residual) {
    Pairs known = known_pairs(residual, residual.value);
    return {std::move(known.y), std::move(known.group)};
}

}  // namespace puckloop::gap::stats
