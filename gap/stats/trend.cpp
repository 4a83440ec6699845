#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::gap::stats {

namespace {
constexpr std::size_t kLeastUnits = 5;

Finding too_few(std::string_view test, std::string_view name, std::size_t units) {
    return {.test = std::string(test),
            .covariate = std::string(name),
            .units = static_cast<double>(units),
            .shape = fmt::format("too few independent values ({})", units)};
}

double relative_size(double effect, const Series& residual) {
    const double scale = robust_scale(residual.value);
    return scale > 0 ? std::fabs(effect) / scale : 0.0;
}

}  // namespace

Finding trend_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options) {
    const Pairs pairs = prepared(residual, covariate);
    if (pairs.size() < kLeastUnits) return too_few("trend", name, pairs.size());
    const std::vector<double> x = ranks(pairs.x);
    Pairs ranked = pairs;
    ranked.y = ranks(pairs.y);
    const double middle = mean(x);
    const auto slope = [&](const std::vector<double>& y) {
        double sum = 0;
        for (std::size_t i = 0; i < y.size(); ++i)
            sum += (x[i] - middle) * y[i];
        return sum;
    };
    Finding finding{.test = "trend", .covariate = std::string(name)};
    finding.units = static_cast<double>(pairs.blocks.size());
    finding.statistic = correlation(x, ranked.y);
    finding.p = permutation_p(
        ranked, [&](const auto& y) { return std::fabs(slope(y)); }, options, fmt::format("trend/{}", name));
    finding.effect = slope_of(pairs) * (quantile(pairs.x, 0.95) - quantile(pairs.x, 0.05));
    finding.relative = relative_size(finding.effect, residual);
    finding.shape = shape_words(profile_of(pairs.x, winsorised(pairs.y)), name);
    return finding;
}

Finding shape_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options) {
    const Pairs pairs = prepared(residual, covariate);
    if (pairs.size() < kLeastUnits) return too_few("shape", name, pairs.size());
    Pairs pulled = pairs;
    pulled.y = winsorised(pairs.y);
    int count = 0;
    const std::vector<int> bin = bins_of(pairs.x, count);
    std::vector<double> size(static_cast<std::size_t>(count), 0.0);
    for (const int b : bin)
        size[static_cast<std::size_t>(b)] += 1;
    std::vector<double> sum(size.size());
    const double centre = mean(pulled.y);
    const auto between = [&](const std::vector<double>& y) {
        std::fill(sum.begin(), sum.end(), 0.0);
        for (std::size_t i = 0; i < y.size(); ++i)
            sum[static_cast<std::size_t>(bin[i])] += y[i] - centre;
        double total = 0;
        for (std::size_t b = 0; b < sum.size(); ++b)
            if (size[b] > 0) total += sum[b] * sum[b] / size[b];
        return total;
    };
    Finding finding{.test = "shape", .covariate = std::string(name)};
    finding.units = static_cast<double>(pairs.blocks.size());
    double total = 0;
    for (const double y : pulled.y)
        total += (y - centre) * (y - centre);
    finding.statistic = total > 0 ? between(pulled.y) / total : 0.0;
    finding.p = permutation_p(pulled, between, options, fmt::format("shape/{}", name));
    const Profile profile = profile_of(pairs.x, pulled.y);
    finding.effect = profile.range();
    finding.relative = relative_size(finding.effect, residual);
    finding.shape = shape_words(profile, name);
    return finding;
}

Finding step_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                  const TestOptions& options) {
    const Pairs pairs = prepared(residual, covariate);
    if (pairs.size() < 2 * kLeastUnits) return too_few("step", name, pairs.size());
    Pairs pulled = pairs;
    pulled.y = winsorised(pairs.y);
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
    Finding finding{.test = "step", .covariate = std::string(name)};
    finding.units = static_cast<double>(pairs.blocks.size());
    finding.statistic = scan(pulled.y);
    finding.effect = jump;
    finding.relative = relative_size(jump, residual);
    const double place = 0.5 * (pairs.x[order[best_at]] + pairs.x[order[best_at + 1]]);
    finding.shape = fmt::format("steps {} at {} {}", jump > 0 ? "up" : "down", name, plain(place));
    finding.p = permutation_p(pulled, scan, options, fmt::format("step/{}", name));
    return finding;
}

}  // namespace puckloop::gap::stats
