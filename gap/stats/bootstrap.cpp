#include "gap/stats/bootstrap.h"

#include "base/random.h"
#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"

#include <cmath>
#include <numeric>

namespace puckloop::gap::stats {

namespace {
constexpr std::size_t kEnoughRuns = 5;
constexpr int kBandDraws = 200;
}  // namespace

std::vector<std::vector<std::size_t>> bootstrap_rows(const Series& series, int draws,
                                                     const TestOptions& options, std::string_view stream) {
    std::vector<Stretch> units = runs_of(series.run);
    if (units.size() < kEnoughRuns) units = blocks_of(series.run, block_length(series));
    RandomStream random(options.seed, stream);
    std::vector<std::vector<std::size_t>> result(static_cast<std::size_t>(draws));
    for (auto& rows : result)
        for (std::size_t u = 0; u < units.size(); ++u) {
            const Stretch& chosen = units[random.below(units.size())];
            for (std::size_t i = chosen.first; i < chosen.last; ++i)
                rows.push_back(i);
        }
    return result;
}

Band bootstrap_band(const Series& residual, const std::vector<double>& covariate, int bins, double coverage,
                    const TestOptions& options) {
    const auto [x, y, run, blocks] = known_pairs(residual, covariate);
    if (x.empty()) return {};
    int count = 0;
    const std::vector<int> bin = bins_of(x, count, bins, 24);
    const auto places = static_cast<std::size_t>(count);
    const auto means = [&](const std::vector<std::size_t>& rows, const std::vector<double>& of) {
        std::vector<double> sum(places, 0.0), n(places, 0.0);
        for (const std::size_t i : rows)
            sum[static_cast<std::size_t>(bin[i])] += of[i], n[static_cast<std::size_t>(bin[i])] += 1;
        for (std::size_t b = 0; b < places; ++b)
            sum[b] = n[b] > 0 ? sum[b] / n[b] : NAN;
        return sum;
    };
    std::vector<std::size_t> all(x.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    Band band{means(all, x), means(all, y), std::vector<double>(places), std::vector<double>(places)};
    std::vector<std::vector<double>> drawn(places);
    for (const auto& rows : bootstrap_rows({y, run}, kBandDraws, options, "band")) {
        const std::vector<double> one = means(rows, y);
        for (std::size_t b = 0; b < places; ++b)
            drawn[b].push_back(one[b]);
    }
    for (std::size_t b = 0; b < places; ++b) {
        band.low[b] = quantile(drawn[b], (1 - coverage) / 2);
        band.high[b] = quantile(drawn[b], (1 + coverage) / 2);
    }
    return band;
}

}  // namespace puckloop::gap::stats
