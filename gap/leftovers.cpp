#include "gap/leftovers.h"

#include "gap/residual_structure.h"
#include "gap/stats/multiple.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr int kPermutations = 299;
constexpr std::size_t kBins = 12;
constexpr std::size_t kLeastInBin = 4;

/// What means in twelve bins of the covariate would gain on standardised innovations, less one nat a bin.
double free_form_gain(const std::vector<double>& residual, const std::vector<double>& covariate) {
    std::vector<double> sorted;
    for (const double value : covariate)
        if (std::isfinite(value)) sorted.push_back(value);
    if (sorted.size() < 2 * kLeastInBin) return 0.0;
    std::sort(sorted.begin(), sorted.end());
    std::vector<double> edges;
    for (std::size_t b = 1; b < kBins; ++b)
        edges.push_back(sorted[b * sorted.size() / kBins]);
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    std::vector<double> sums(edges.size() + 1, 0.0), counts(edges.size() + 1, 0.0);
    for (std::size_t i = 0; i < residual.size(); ++i) {
        if (!std::isfinite(covariate[i])) continue;
        const auto bin = static_cast<std::size_t>(std::upper_bound(edges.begin(), edges.end(), covariate[i]) -
                                                  edges.begin());
        sums[bin] += std::clamp(residual[i], -4.0, 4.0);
        counts[bin] += 1;
    }
    double gain = 0.0;
    for (std::size_t b = 0; b < sums.size(); ++b)
        if (counts[b] >= kLeastInBin) gain += sums[b] * sums[b] / counts[b] / 2 - 1;
    return gain;
}

}  // namespace

std::vector<LeftStructure> leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
                                        std::uint64_t seed, double level) {
    stats::TestOptions options;
    options.seed = seed;
    options.permutations = kPermutations;
    std::vector<std::vector<stats::Finding>> tables;
    for (const Series& one :
         series)  // the firmware makes the counters: whole steps have structure of their own
        tables.push_back(one.observable.starts_with("steps_")
                             ? std::vector<stats::Finding>{}
                             : residual_structure(experiment, one, Stage::After, options));
    std::vector<std::vector<stats::Finding>*> all;
    for (auto& table : tables)
        all.push_back(&table);
    stats::adjust_together(all);
    std::vector<LeftStructure> left;
    for (std::size_t o = 0; o < series.size(); ++o) {
        const auto covariates = covariates_of(experiment, series[o]);
        const auto residual = residual_of(series[o], Stage::After);
        for (const stats::Finding& finding : tables[o]) {
            // Tails and held samples are the noise's business; what is carried over is in its model.
            if (finding.p_adjusted > level || finding.test == "outliers" || finding.test == "held") continue;
            LeftStructure one{{series[o].observable,
                               finding.covariate.empty() ? finding.test : finding.covariate,
                               finding.p_adjusted, finding.shape},
                              finding.relative,
                              0.0};
            for (const auto& covariate : covariates)
                if (covariate.name == finding.covariate) one.gain = free_form_gain(residual, covariate.value);
            left.push_back(std::move(one));
        }
    }
    std::stable_sort(left.begin(), left.end(),
                     [](const auto& a, const auto& b) { return a.told.p_value < b.told.p_value; });
    return left;
}

}  // namespace puckloop::gap
