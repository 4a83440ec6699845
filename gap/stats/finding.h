#pragma once
// What one structure test found, and what the tests share: seed, number of permutations, how p comes about.
//
// p values stay valid when residuals depend on each other: the tests permute blocks of rows (or whole runs),
// never single rows of a correlated series. See gap/stats/exchange.h.

#include <cstdint>
#include <string>
#include <utility>

namespace puckloop::gap::stats {

struct Finding {
    std::string test{};             ///< "trend", "shape", "sign", "periodic", ...
    std::string covariate{};        ///< against what; empty for tests of the series alone
    double rank_correlation = 0.0;  ///< of a trend: Spearman's
    double p = 1.0;                 ///< of this test alone
    double p_adjusted = 1.0;        ///< after correction for all tests of the table
    double effect = 0.0;            ///< size, in the residual's unit unless `effect_unit` is another
    std::string effect_unit{};      ///< empty: the residual's own; else "", "fraction", "correlation", ...
    double relative = 0.0;  ///< |effect| over the residual's robust scale (0 where that has no meaning)
    std::string shape{};    ///< in words: "grows with distance, zero at zero"
};

/// The same with nothing found, for want of what `why` names.
inline Finding not_asked(Finding finding, std::string why = "too few values") {
    finding.shape = std::move(why);
    return finding;
}

struct TestOptions {
    std::uint64_t seed = 1;
    int permutations = 999;  ///< at most; a test stops early when nothing is there
};

}  // namespace puckloop::gap::stats
