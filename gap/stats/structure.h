#pragma once
// All structure tests of one observable's residual against all its covariates, corrected together.

#include "gap/stats/finding.h"
#include "gap/stats/series.h"

#include <span>
#include <string>
#include <vector>

namespace puckloop::gap::stats {

enum class CovariateKind {
    Number,  ///< distance, speed, temperature, ...: trend, shape and step tests
    Signed,  ///< a number whose sign and reversals mean something too (speed, command, turn rate)
    Label    ///< session, unit, surface: group test on whole numbers 0, 1, ...
};

struct Covariate {
    std::string name;
    CovariateKind kind = CovariateKind::Number;
    std::vector<double> value;        ///< a value a row, NaN where unknown
    std::vector<std::string> labels;  ///< names of the groups of a Label
};

struct StructureInput {
    Series residual;
    std::vector<double> time;   ///< s, rising inside runs; empty: no spectrum
    std::vector<double> level;  ///< predicted value: does the scatter depend on it; empty: not asked
    std::vector<double> raw;    ///< measured values: held samples; empty: not asked
    std::vector<Covariate> covariates;
};

/// Every test that applies, in a fixed order; `p_adjusted` by Holm over the whole table. A covariate without
/// two different values is left out; a residual without any has no findings.
std::vector<Finding> structure_table(const StructureInput& input, const TestOptions& options);

/// Holm's step-down adjusted p values: the chance of even one false alarm in the table stays below p.
std::vector<double> holm(const std::vector<double>& p);

/// Holm over several observables' tables together.
void adjust_together(std::span<std::vector<Finding>> tables);

}  // namespace puckloop::gap::stats
