#include "gap/stats/bootstrap.h"

#include "gap/stats/exchange.h"
#include "gap/stats/robust.h"

namespace puckloop::gap::stats {

namespace {
constexpr std::size_t kEnoughRunsToResample = 5;
constexpr int kBandDraws = 200;
}  // namespace

std::vector<std::vector<std::size_t>> bootstrap_rows(const Series& series, int draws, RandomStream& random) {
    std::vector<Stretch> units = runs_of(series.run);
    if (units.size() < kEnoughRunsToResample) units = blocks_of(series.run, block_length(series));
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
                    std::uint64_t seed) {
    const auto [x, y, run, blocks] = known_pairs(residual, covariate);
    if (x.empty()) return {};
    int count = 0;
    const std::vector<int> bin = bins_of(x, count, bins, 24);
    const auto places = static_cast<std::size_t>(count);
    Band band{means_at(bin, count, x), means_at(bin, count, y), std::vector<double>(places),
              std::vector<double>(places)};
    std::vector<std::vector<double>> drawn(places);
    RandomStream random(seed, "band");
    for (const auto& rows : bootstrap_rows({y, run}, kBandDraws, random)) {
        std::vector<double> resampled;
        std::vector<int> place;
        for (const std::size_t i : rows) {
            resampled.push_back(y[i]);
            place.push_back(bin[i]);
        }
        const std::vector<double> one = means_at(place, count, resampled);
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
