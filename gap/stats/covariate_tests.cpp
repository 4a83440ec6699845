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

/// p of the share of variance between groups: `group` of each value, from 0.
double p_between(const Pairs& pairs, const std::vector<int>& group, int count, const TestOptions& options,
                 std::string_view stream) {
    std::vector<double> rows(static_cast<std::size_t>(count), 0.0), sum;
    for (const int one : group)
        rows[static_cast<std::size_t>(one)] += 1;
    const double centre = mean(pairs.y);
    const auto between = [&](const std::vector<double>& y) {
        sum.assign(rows.size(), 0.0);
        for (std::size_t i = 0; i < y.size(); ++i)
            sum[static_cast<std::size_t>(group[i])] += y[i] - centre;
        double total = 0;
        for (std::size_t g = 0; g < sum.size(); ++g)
            if (rows[g] > 0) total += sum[g] * sum[g] / rows[g];
        return total;
    };
    return permutation_p(pairs, between, options, stream);
}

/// Labels of units that mix two groups (a run mean over both) go to the nearer one.
Finding compared(const Series& residual, const std::vector<double>& label, std::string_view test,
                 std::string_view name, const std::vector<std::string>& label_names,
                 const TestOptions& options) {
    Pairs pairs = prepared(residual, label);
    pairs.y = pulled_in(residual, pairs.y);
    Finding finding{.test = std::string(test), .covariate = std::string(name)};
    std::vector<long> key;
    for (const double one : pairs.x)
        key.push_back(std::lround(one));
    std::ranges::sort(key);
    key.erase(std::unique(key.begin(), key.end()), key.end());
    if (key.size() < 2) return not_asked(finding, fmt::format("one {} only", name));
    if (pairs.blocks.size() < key.size() + 2)
        return not_asked(finding, fmt::format("too few runs or blocks for {}", name));
    std::vector<int> group;
    for (const double one : pairs.x)
        group.push_back(static_cast<int>(std::ranges::lower_bound(key, std::lround(one)) - key.begin()));
    const int count = static_cast<int>(key.size());
    finding.p = p_between(pairs, group, count, options, fmt::format("{}/{}", test, name));
    const std::vector<double> means = means_at(group, count, pairs.y);
    const auto low = std::ranges::min_element(means), high = std::ranges::max_element(means);
    finding.effect = *high - *low;
    finding.relative = beside_scatter(finding.effect, residual);
    const auto called = [&](auto at) {
        const long one = key[static_cast<std::size_t>(at - means.begin())];
        const auto index = static_cast<std::size_t>(one);
        return one >= 0 && index < label_names.size() ? label_names[index] : std::to_string(one);
    };
    finding.shape = fmt::format("differs by {}: highest {}, lowest {}", name, called(high), called(low));
    return finding;
}

}  // namespace

Finding trend_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options) {
    const Pairs pairs = prepared(residual, covariate);
    Finding finding{.test = "trend", .covariate = std::string(name)};
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
    finding.rank_correlation = correlation(x, ranked.y);
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
    Finding finding{.test = "step", .covariate = std::string(name)};
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
    scan(pairs.y);
    finding.effect = jump;
    finding.relative = beside_scatter(jump, residual);
    const double place = 0.5 * (pairs.x[order[best_at]] + pairs.x[order[best_at + 1]]);
    finding.shape = fmt::format("steps {} at {} {}", jump > 0 ? "up" : "down", name, plain(place));
    finding.p = permutation_p(pairs, scan, options, fmt::format("step/{}", name));
    return finding;
}

Finding group_test(const Series& residual, const std::vector<int>& label, std::string_view name,
                   const std::vector<std::string>& label_names, const TestOptions& options) {
    return compared(residual, std::vector<double>(label.begin(), label.end()), "group", name, label_names,
                    options);
}

Finding shape_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options) {
    Pairs pairs = prepared(residual, covariate);
    Finding finding{.test = "shape", .covariate = std::string(name)};
    if (pairs.size() < kLeastUnits) return too_few(finding, pairs);
    pairs.y = pulled_in(residual, pairs.y);
    int count = 0;
    const std::vector<int> bin = bins_of(pairs.x, count);
    finding.p = p_between(pairs, bin, count, options, fmt::format("shape/{}", name));
    const Profile profile = profile_of(pairs.x, pairs.y);
    finding.effect = profile.range();
    finding.relative = beside_scatter(finding.effect, residual);
    finding.shape = shape_words(profile, name);
    return finding;
}

Finding reversal_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                      std::size_t rows, const TestOptions& options) {
    std::vector<double> after(residual.size(), 0.0);
    std::size_t left = 0;
    double last_sign = 0;
    for (std::size_t i = 0; i < residual.size(); ++i) {
        if (i == 0 || residual.run[i] != residual.run[i - 1]) left = 0, last_sign = 0;
        const double sign = covariate[i] > 0 ? 1.0 : covariate[i] < 0 ? -1.0 : 0.0;
        if (sign != 0 && last_sign != 0 && sign != last_sign) left = rows;
        if (sign != 0) last_sign = sign;
        if (left > 0) after[i] = last_sign > 0 ? 2.0 : 1.0, --left;
    }
    return compared(residual, after, "reversal", fmt::format("reversal of {}", name),
                    {"elsewhere", "after turning negative", "after turning positive"}, options);
}

Finding spread_test(const Series& residual, const std::vector<double>& level, std::string_view name,
                    const TestOptions& options) {
    // Distance from a local median, so that a bias against the level is not taken for scatter.
    int count = 0;
    const auto [x, y, run, blocks] = known_pairs(residual, level);
    Finding finding{.test = "spread", .covariate = std::string(name), .effect_unit = "ratio - 1"};
    if (x.size() < 20) return not_asked(finding);
    const std::vector<int> bin = bins_of(x, count);
    std::vector<std::vector<double>> inside(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < x.size(); ++i)
        inside[static_cast<std::size_t>(bin[i])].push_back(y[i]);
    std::vector<double> centre, scatter;
    for (const auto& values : inside)
        centre.push_back(median(values));
    for (std::size_t i = 0; i < x.size(); ++i)
        scatter.push_back(std::fabs(y[i] - centre[static_cast<std::size_t>(bin[i])]));
    const Finding trend = trend_test({scatter, run}, x, name, options);
    finding.p = trend.p;
    std::vector<double> lowest, highest;
    const double low = quantile(x, 0.2), high = quantile(x, 0.8);
    for (std::size_t i = 0; i < x.size(); ++i) {
        if (x[i] <= low) lowest.push_back(scatter[i]);
        if (x[i] >= high) highest.push_back(scatter[i]);
    }
    const double below = mean(lowest), above = mean(highest);
    finding.effect = below > 0 ? above / below - 1 : 0.0;
    finding.shape =
        fmt::format("scatter {} with the predicted {} (mean size {} where it is low, {} where it is high, in "
                    "units of the noise)",
                    trend.rank_correlation > 0 ? "grows" : "shrinks", name, plain(below), plain(above));
    return finding;
}

}  // namespace puckloop::gap::stats
