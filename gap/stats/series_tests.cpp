#include "gap/stats/exchange.h"
#include "gap/stats/profile.h"
#include "gap/stats/robust.h"
#include "gap/stats/tails.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::gap::stats {

namespace {

constexpr double kWild = 4.0;            // robust deviations
constexpr double kNormalWild = 6.33e-5;  // share of a normal sample beyond, both sides
// Allowed before the tail counts as heavy: residuals of a good model are seldom quite normal.
constexpr double kAllowedShare = 2e-3;
// Stretches whose scatter is compared: so few, and so long, that each knows its own to a fifth.
constexpr std::size_t kTestedStretches = 4, kStretchRows = 12;

/// P(difference = 0) of a bell-shaped histogram of differences, from its places at one and two quanta.
double repeats_of_bell(const Series& series) {
    std::vector<double> steps;
    for (std::size_t i = 1; i < series.size(); ++i)
        if (series.run[i] == series.run[i - 1])
            steps.push_back(std::fabs(series.value[i] - series.value[i - 1]));
    double quantum = std::numeric_limits<double>::infinity();
    for (const double s : steps)
        if (s > 0) quantum = std::min(quantum, s);
    double one = 0, two = 0;
    for (const double s : steps) {
        one += std::fabs(s - quantum) < 0.01 * quantum ? 0.5 : 0.0;
        two += std::fabs(s - 2 * quantum) < 0.01 * quantum ? 0.5 : 0.0;
    }
    if (one == 0 || two == 0) return 0.0;
    return std::min(one / static_cast<double>(steps.size()) * std::cbrt(std::max(one / two, 1.0)), 1.0);
}

}  // namespace

Finding serial_test(const Series& residual, const TestOptions& options) {
    Series series = without_gaps(residual);
    Finding finding{.test = "previous", .covariate = "previous sample", .effect_unit = "correlation"};
    if (series.size() < 10) return not_asked(finding);
    series.value = pulled_in(residual, series.value);
    finding.effect = autocorrelation(series, 1).front();
    const std::vector<Stretch> runs = runs_of(series.run);
    Series shuffled = series;
    const auto draw = [&](RandomStream& random) {
        for (const Stretch& run : runs)
            shuffle(std::span(shuffled.value).subspan(run.first, run.size()), random);
        return std::fabs(autocorrelation(shuffled, 1).front());
    };
    finding.p =
        null_p(std::fabs(finding.effect), static_cast<double>(series.size()), draw, options, "previous");
    finding.shape = finding.effect < 0
                        ? "alternates: a high value is followed by a low one"
                        : fmt::format("carries over: {:.3g} rows are worth one", correlation_length(series));
    return finding;
}

Finding run_order_test(const Series& residual, const TestOptions& options) {
    Series means;
    std::vector<double> place;
    for (const Stretch& run : runs_of(residual.run)) {
        const double* values = residual.value.data();
        means.value.push_back(mean({values + run.first, values + run.last}));
        means.run.push_back(0);
        place.push_back(static_cast<double>(place.size()));
    }
    Finding finding = trend_test(means, place, "run order", options);
    finding.test = "order";
    return finding;
}

Finding held_test(const Series& raw, const TestOptions& options) {
    const Series series = without_gaps(raw);
    Finding finding{.test = "held", .covariate = "previous sample", .effect_unit = "fraction"};
    if (series.size() < 10) return not_asked(finding);
    // Under chance alone repeats come as often one row apart as two and more rows apart (nearby rows, so that
    // a slow drift or a coarse quantum makes both alike): compare lag 1 with lags 6 to 10.
    const auto repeats = [&](std::size_t lag) {
        double same = 0, all = 0;
        for (const Stretch& s : runs_of(series.run))
            for (std::size_t i = s.first; i + lag < s.last; ++i)
                same += series.value[i] == series.value[i + lag] ? 1 : 0, all += 1;
        return std::pair{same, all};
    };
    const auto [same, all] = repeats(1);
    double chance = 0, chances = 0;
    for (std::size_t lag = 6; lag <= 10; ++lag) {
        const auto [s, a] = repeats(lag);
        chance += s, chances += a;
    }
    const double expected = std::max(chances > 0 ? chance / chances : 0.0, repeats_of_bell(series));
    const double share = all > 0 ? same / all : 0.0;
    finding.effect = share - expected;
    const auto draw = [&](RandomStream& random) {  // binomial with the chance rate, normal form
        const double sd = std::sqrt(std::max(expected * (1 - expected), 1 / std::max(all, 1.0)) / all);
        return expected + sd * random.normal();
    };
    finding.p = all > 0 ? null_p(share, all, draw, options, "held") : 1.0;
    finding.shape = fmt::format("{:.3g} % of successive rows are equal, chance makes {:.3g} %", 100 * share,
                                100 * expected);
    return finding;
}

Finding outlier_test(const Series& residual, const TestOptions&) {
    Finding finding{.test = "outliers", .effect_unit = "fraction"};
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
    if (values < 20) return not_asked(finding);
    finding.effect = (high + low) / values;
    finding.p = poisson_tail(values * std::max(kNormalWild, kAllowedShare), clusters);
    const std::string_view side = high > 3 * low + 2   ? "high side only"
                                  : low > 3 * high + 2 ? "low side only"
                                                       : "both sides";
    finding.shape =
        fmt::format("{:.3g} % outliers, {} ({} high, {} low)", 100 * finding.effect, side, high, low);
    return finding;
}

Finding evenness_test(const Series& residual, const TestOptions& options) {
    const Series kept = without_gaps(residual);
    Finding finding{.test = "evenness", .covariate = "stretch of a run", .effect_unit = "ratio - 1"};
    std::vector<Stretch> stretches;
    for (const Stretch& run : runs_of(kept.run)) {
        const std::size_t parts = std::clamp<std::size_t>(run.size() / kStretchRows, 1, kTestedStretches);
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
            distance.assign(y.data() + one.first, y.data() + one.last);
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
    const double measured = statistic(values);
    const auto [low, high] = std::ranges::minmax_element(means);
    finding.effect = *low > 0 ? *high / *low - 1 : 0.0;
    finding.shape = fmt::format("scatter differs between stretches of runs: {} to {} times the noise",
                                plain(*low), plain(*high));
    std::vector<double> y = values;
    const auto draw = [&](RandomStream& random) {
        shuffle(std::span(y), random);
        return statistic(y);
    };
    finding.p = null_p(measured, static_cast<double>(kept.size()), draw, options, "evenness");
    return finding;
}

}  // namespace puckloop::gap::stats
