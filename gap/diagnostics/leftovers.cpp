#include "gap/diagnostics/leftovers.h"

#include "gap/diagnostics/residual_structure.h"
#include "gap/stats/multiple.h"

#include <algorithm>
#include <cmath>

namespace puckloop::gap {

namespace {

constexpr int kPermutations = 299;

}  // namespace

std::vector<Leftover> leftovers_of(const Experiment& experiment, const std::vector<Series>& series,
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
    std::vector<Leftover> left;
    for (std::size_t o = 0; o < series.size(); ++o) {
        for (const stats::Finding& finding : tables[o]) {
            // Tails and held samples are the noise's business; what is carried over is in its model.
            if (finding.p_adjusted > level || finding.test == "outliers" || finding.test == "held") continue;
            left.push_back({series[o].observable,
                            finding.covariate.empty() ? finding.test : finding.covariate, finding.p_adjusted,
                            finding.shape});
        }
    }
    std::stable_sort(left.begin(), left.end(),
                     [](const auto& a, const auto& b) { return a.p_value < b.p_value; });
    return left;
}

}  // namespace puckloop::gap
