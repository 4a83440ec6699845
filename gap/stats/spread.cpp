#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/shuffle.h"
#include "gap/stats/tails.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::gap::stats {

namespace {
constexpr double kWild = 4.0;            // robust deviations
constexpr double kNormalWild = 6.33e-5;  // share of a normal sample beyond, both sides
// Allowed before the tail counts as heavy: residuals of a good model are seldom quite normal.
constexpr double kAllowedShare = 2e-3;
// Stretches whose scatter is compared: so few, and so long, that each knows its own to a fifth.
constexpr std::size_t kStretches = 4, kStretchRows = 12;
}  // namespace

Finding outlier_test(const Series& residual, const TestOptions&) {
    Finding finding{.test = "outliers", .covariate = ""};
    finding.effect_unit = "fraction";
    const double centre = median(residual.value);
    const double scale = robust_scale(residual.value);
    double values = 0;
    unsigned high = 0, low = 0, clusters = 0;
    bool wild_before = false;
    for (std::size_t i = 0; i < residual.size(); ++i) {
        if (i > 0 && residual.run[i] != residual.run[i - 1]) wild_before = false;
        if (!std::isfinite(residual.value[i])) continue;
        values += 1;
        const double z = scale > 0 ? (residual.value[i] - centre) / scale : 0.0;
        const bool wild = std::fabs(z) > kWild;
        if (wild) z > 0 ? ++high : ++low;
        if (wild && !wild_before) ++clusters;
        wild_before = wild;
    }
    finding.units = values;
    if (values < 20) return not_asked(finding);
    finding.effect = (high + low) / values;
    finding.statistic = clusters;
    finding.p = poisson_tail(values * std::max(kNormalWild, kAllowedShare), clusters);
    const std::string_view side = high > 3 * low + 2   ? "high side only"
                                  : low > 3 * high + 2 ? "low side only"
                                                       : "both sides";
    finding.shape =
        fmt::format("{:.3g} % outliers, {} ({} high, {} low)", 100 * finding.effect, side, high, low);
    return finding;
}

Finding spread_test(const Series& residual, const std::vector<double>& level, std::string_view name,
                    const TestOptions& options) {
    // Distance from a local median, so that a bias against the level is not taken for scatter.
    int count = 0;
    const auto [x, y, run, blocks] = known_pairs(residual, level);
    Finding finding{.test = "spread", .covariate = std::string(name)};
    finding.effect_unit = "ratio - 1";
    if (x.size() < 20) return not_asked(finding);
    const std::vector<int> bin = bins_of(x, count);
    std::vector<double> scatter(x.size());
    for (int b = 0; b < count; ++b) {
        std::vector<double> inside;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (bin[i] == b) inside.push_back(y[i]);
        const double centre = median(inside);
        for (std::size_t i = 0; i < x.size(); ++i)
            if (bin[i] == b) scatter[i] = std::fabs(y[i] - centre);
    }
    const Finding trend = trend_test({scatter, run}, x, name, options);
    finding.statistic = trend.statistic;
    finding.p = trend.p;
    finding.units = trend.units;
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
                    finding.statistic > 0 ? "grows" : "shrinks", name, plain(below), plain(above));
    return finding;
}

Finding evenness_test(const Series& residual, const TestOptions& options) {
    const Series kept = without_gaps(residual);
    Finding finding{.test = "evenness", .covariate = "stretch of a run"};
    finding.effect_unit = "ratio - 1";
    finding.units = static_cast<double>(kept.size());
    std::vector<Stretch> stretches;
    for (const Stretch& run : runs_of(kept.run)) {
        const std::size_t parts = std::clamp<std::size_t>(run.size() / kStretchRows, 1, kStretches);
        for (std::size_t k = 0; k < parts; ++k)
            stretches.push_back(
                {run.first + k * run.size() / parts, run.first + (k + 1) * run.size() / parts, run.run});
    }
    std::erase_if(stretches, [](const Stretch& one) { return one.size() < kStretchRows; });
    if (stretches.size() < 2) return not_asked(finding);
    std::vector<double> values = winsorised(kept.value), distance, means;
    const auto statistic = [&](const std::vector<double>& y) {
        double between = 0, within = 0, all = 0, rows = 0;
        means.clear();
        for (const Stretch& one : stretches) {
            const auto at = y.begin() + static_cast<std::ptrdiff_t>(one.first);
            distance.assign(at, at + static_cast<std::ptrdiff_t>(one.size()));
            const double centre = median(distance);
            double sum = 0, square = 0;
            for (const double v : distance) {
                sum += std::fabs(v - centre);
                square += (v - centre) * (v - centre);
            }
            const double n = static_cast<double>(one.size());
            means.push_back(sum / n);
            between += sum * sum / n;
            within += square - sum * sum / n;
            all += sum;
            rows += n;
        }
        return within > 0 ? (between - all * all / rows) / within : 0.0;
    };
    finding.statistic = statistic(values);
    const auto [low, high] = std::ranges::minmax_element(means);
    finding.effect = *low > 0 ? *high / *low - 1 : 0.0;
    finding.shape = fmt::format("scatter differs between stretches of runs: {} to {} times the noise",
                                plain(*low), plain(*high));
    std::vector<double> y = values;
    const auto draw = [&](RandomStream& random) {
        shuffle(std::span(y), random);
        return statistic(y);
    };
    finding.p = null_p(finding.statistic, finding.units, draw, options, "evenness");
    return finding;
}

}  // namespace puckloop::gap::stats
