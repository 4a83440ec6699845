#include "gap/diagnostics/leftovers.h"

#include "gap/evidence/thresholds.h"
#include "gap/residuals/residual_structure.h"
#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr int kPermutations = 299;

/// Is it no more than rounding can make: a difference below the step, or errors that are all rounding?
bool is_rounding(const stats::Finding& finding, const Series& series, double quantum) {
    if (!(quantum > 0)) return false;
    const double sd = stats::median(series.scale);
    // What rounds up in one row is taken back in the next: of a sum's steps a share of their variance.
    if (finding.test == "previous" && finding.effect < 0)
        return -finding.effect * sd * sd < quantum * quantum / 12;
    const bool sized = finding.test == "shape" || finding.test == "group" || finding.test == "reversal" ||
                       finding.test == "trend" || finding.test == "step";
    return sized ? std::abs(finding.effect) * sd < quantum : sd < quantum / 2;
}

}  // namespace

std::vector<Leftover> leftovers_of(const Experiment& experiment, const std::vector<Observable>& observables,
                                   const std::vector<Series>& series, std::uint64_t seed) {
    const stats::TestOptions options{.seed = seed, .permutations = kPermutations};
    std::vector<std::vector<stats::Finding>> tables;
    for (std::size_t o = 0; o < series.size(); ++o) {
        auto table = is_counter(series[o].observable)
                         ? std::vector<stats::Finding>{}
                         : residual_structure(experiment, series[o], Stage::After, options);
        std::erase_if(table, [&](const stats::Finding& one) {
            return is_rounding(one, series[o], observables[o].instrument.quantum);
        });
        tables.push_back(std::move(table));
    }
    stats::adjust_together(tables);
    std::vector<Leftover> left;
    for (std::size_t o = 0; o < series.size(); ++o)
        for (const stats::Finding& finding : tables[o]) {
            // Tails and held samples are the noise's business; what is carried over is in its model.
            if (finding.p_adjusted > thresholds::kReported || finding.test == "outliers" ||
                finding.test == "held")
                continue;
            const std::string against = finding.covariate.empty()      ? finding.test
                                        : finding.covariate == "level" ? "predicted level"
                                                                       : finding.covariate;
            left.push_back({series[o].observable, against, finding.p_adjusted, finding.shape});
        }
    std::ranges::stable_sort(left, {}, &Leftover::p_value);
    return left;
}

}  // namespace puckloop::gap
