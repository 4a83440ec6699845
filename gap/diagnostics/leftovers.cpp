#include "gap/diagnostics/leftovers.h"

#include "gap/diagnostics/residual_structure.h"
#include "gap/stats/robust.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr int kPermutations = 299;
constexpr double kBins = 12.0;  // at most, of a shape

/// nats that a correction by the structure would gain: of normal errors n/2 times the share of variance it
/// makes, less what its numbers cost (Schwarz). A test whose statistic is no share says nothing of it.
double gain_of_structure(const stats::Finding& finding, double rows) {
    const bool shares = finding.test == "shape" || finding.test == "group" || finding.test == "reversal";
    const double share = shares                    ? finding.statistic
                         : finding.test == "trend" ? finding.statistic * finding.statistic
                                                   : 0.0;
    const double numbers = finding.test == "trend" ? 1.0 : finding.test == "shape" ? kBins - 1 : 2.0;
    return std::max(rows * share / 2 - numbers / 2 * std::log(rows), 0.0);
}

/// Is it no more than rounding can make: a difference below the step, or errors that are all rounding?
bool is_rounding(const stats::Finding& finding, const Series& series, double quantum) {
    if (!(quantum > 0)) return false;
    const double sd = stats::median(series.scale);
    const bool sized = finding.test == "shape" || finding.test == "group" || finding.test == "reversal" ||
                       finding.test == "trend" || finding.test == "step";
    return sized ? std::abs(finding.effect) * sd < quantum : sd < quantum / 2;
}

}  // namespace

Left leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
                  const std::vector<double>& quanta, std::uint64_t seed, double level, double sure) {
    stats::TestOptions options;
    options.seed = seed;
    options.permutations = kPermutations;
    std::vector<std::vector<stats::Finding>> tables;
    for (std::size_t o = 0; o < series.size(); ++o) {
        // The firmware makes the counters: whole steps have structure of their own.
        auto table = series[o].observable.starts_with("steps_")
                         ? std::vector<stats::Finding>{}
                         : residual_structure(experiment, series[o], Stage::After, options);
        std::erase_if(table,
                      [&](const stats::Finding& one) { return is_rounding(one, series[o], quanta[o]); });
        tables.push_back(std::move(table));
    }
    std::vector<std::vector<stats::Finding>*> all;
    for (auto& table : tables)
        all.push_back(&table);
    stats::adjust_together(all);
    Left left;
    for (std::size_t o = 0; o < series.size(); ++o) {
        double largest = 0.0;
        for (const stats::Finding& finding : tables[o]) {
            // Tails and held samples are the noise's business; what is carried over is in its model.
            if (finding.p_adjusted > level || finding.test == "outliers" || finding.test == "held") continue;
            left.structures.push_back({series[o].observable,
                                       finding.covariate.empty() ? finding.test : finding.covariate,
                                       finding.p_adjusted, finding.shape});
            if (finding.p_adjusted < sure)
                largest =
                    std::max(largest, gain_of_structure(finding, static_cast<double>(series[o].run.size())));
        }
        left.gain += largest;
    }
    std::stable_sort(left.structures.begin(), left.structures.end(),
                     [](const auto& a, const auto& b) { return a.p_value < b.p_value; });
    return left;
}

}  // namespace puckloop::gap
