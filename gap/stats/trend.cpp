#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap::stats {

Finding trend_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options) {
    const Pairs pairs = prepared(residual, covariate);
    Finding finding = begun("trend", name, pairs);
    if (pairs.size() < kLeastUnits) return too_few(finding, pairs);
    const std::vector<double> x = ranks(pairs.x);
    Pairs ranked = pairs;
    if (!residual.events) ranked.y = ranks(pairs.y);
    const double middle = mean(x);
    const auto slope = [&](const std::vector<double>& y) {
        double sum = 0;
        for (std::size_t i = 0; i < y.size(); ++i)
            sum += (x[i] - middle) * y[i];
        return sum;
    };
    finding.statistic = correlation(x, ranked.y);
    finding.p = permutation_p(
        ranked, [&](const auto& y) { return std::fabs(slope(y)); }, options, fmt::format("trend/{}", name));
    finding.effect = slope_of(pairs) * (quantile(pairs.x, 0.95) - quantile(pairs.x, 0.05));
    finding.relative = beside_scatter(finding.effect, residual);
    finding.shape = shape_words(profile_of(pairs.x, pulled_in(residual, pairs.y)), name);
    return finding;
}

Finding step_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                  const TestOptions& options) {
    Pairs pairs = prepared(residual, covariate);
    Finding finding = begun("step", name, pairs);
    if (pairs.size() < 2 * kLeastUnits) return too_few(finding, pairs);
    pairs.y = pulled_in(residual, pairs.y);
    const auto order = ordered(pairs.size(), [&](auto a, auto b) { return pairs.x[a] < pairs.x[b]; });
    const double n = static_cast<double>(pairs.size());
    const auto least = static_cast<std::size_t>(std::max(2.0, n / 20));
    std::size_t best_at = 0;
    double jump = 0;
    const auto scan = [&](const std::vector<double>& y) {
        const double total = std::accumulate(y.begin(), y.end(), 0.0);
        double below = 0, best = 0;
        for (std::size_t k = 0; k + 1 < order.size(); ++k) {
            below += y[order[k]];
            if (k + 1 < least || order.size() - k - 1 < least || pairs.x[order[k]] == pairs.x[order[k + 1]])
                continue;
            const double count = static_cast<double>(k + 1);
            const double difference = (total - below) / (n - count) - below / count;
            const double score = difference * difference * count * (n - count) / n;
            if (score > best) best = score, best_at = k, jump = difference;
        }
        return best;
    };
    finding.statistic = scan(pairs.y);
    finding.effect = jump;
    finding.relative = beside_scatter(jump, residual);
    const double place = 0.5 * (pairs.x[order[best_at]] + pairs.x[order[best_at + 1]]);
    finding.shape = fmt::format("steps {} at {} {}", jump > 0 ? "up" : "down", name, plain(place));
    finding.p = permutation_p(pairs, scan, options, fmt::format("step/{}", name));
    return finding;
}

}  // namespace puckloop::gap::stats
