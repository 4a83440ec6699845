#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"
#include "gap/stats/shuffle.h"
#include "gap/stats/tests.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::gap::stats {

namespace {

void shuffle_rows(std::vector<double>& y, const std::vector<Stretch>& runs, RandomStream& random) {
    for (const Stretch& s : runs)
        shuffle(std::span(y).subspan(s.first, s.size()), random);
}

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
    Finding finding{.test = "previous", .covariate = "previous sample"};
    finding.effect_unit = "correlation";
    finding.units = static_cast<double>(series.size());
    if (series.size() < 10) return not_asked(finding);
    series.value = pulled_in(residual, series.value);
    finding.statistic = finding.effect = autocorrelation(series, 1).front();
    const std::vector<Stretch> runs = runs_of(series.run);
    Series shuffled = series;
    const auto draw = [&](RandomStream& random) {
        shuffle_rows(shuffled.value, runs, random);
        return std::fabs(autocorrelation(shuffled, 1).front());
    };
    finding.p = null_p(std::fabs(finding.effect), finding.units, draw, options, "previous");
    finding.shape = finding.effect < 0
                        ? "alternates: a high value is followed by a low one"
                        : fmt::format("carries over: {:.3g} rows are worth one", correlation_length(series));
    return finding;
}

Finding run_order_test(const Series& residual, const TestOptions& options) {
    const std::vector<Stretch> runs = runs_of(residual.run);
    Series means;
    std::vector<double> place;
    for (std::size_t r = 0; r < runs.size(); ++r) {
        const auto at = [&](std::size_t i) {
            return residual.value.begin() + static_cast<std::ptrdiff_t>(i);
        };
        means.value.push_back(mean({at(runs[r].first), at(runs[r].last)}));
        means.run.push_back(0);
        place.push_back(static_cast<double>(r));
    }
    Finding finding = trend_test(means, place, "run order", options);
    finding.test = "order";
    return finding;
}

Finding held_test(const Series& raw, const TestOptions& options) {
    const Series series = without_gaps(raw);
    Finding finding{.test = "held", .covariate = "previous sample"};
    finding.effect_unit = "fraction";
    finding.units = static_cast<double>(series.size());
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
    finding.statistic = all > 0 ? same / all : 0.0;
    finding.effect = finding.statistic - expected;
    const auto draw = [&](RandomStream& random) {  // binomial with the chance rate, normal form
        const double sd = std::sqrt(std::max(expected * (1 - expected), 1 / std::max(all, 1.0)) / all);
        return expected + sd * random.normal();
    };
    finding.p = all > 0 ? null_p(finding.statistic, all, draw, options, "held") : 1.0;
    finding.shape = fmt::format("{:.3g} % of successive rows are equal, chance makes {:.3g} %",
                                100 * finding.statistic, 100 * expected);
    return finding;
}

}  // namespace puckloop::gap::stats
