#pragma once
// The structure tests: each asks one question of a residual. All are seeded, none throws for lack of data:
// too few values give p = 1 and say so in `shape`.

#include "gap/stats/finding.h"
#include "gap/stats/series.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap::stats {

/// Does it rise or fall with the covariate? Spearman's correlation; effect: slope times the covariate's
/// 5-95 % range.
Finding trend_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options);

/// Does it depend on the covariate in any way? Share of variance between bins; effect: range of the bin
/// means.
Finding shape_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                   const TestOptions& options);

/// Does it jump at some value of the covariate? Largest standardised difference over all splits.
Finding step_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                  const TestOptions& options);

/// Does it differ between groups (labels: session, unit, sign of a command)? Effect: range of the group
/// means.
Finding group_test(const Series& residual, const std::vector<int>& label, std::string_view name,
                   const std::vector<std::string>& label_names, const TestOptions& options);

/// Is the value different just after the covariate changed its sign (the next `rows` rows)?
Finding reversal_test(const Series& residual, const std::vector<double>& covariate, std::string_view name,
                      std::size_t rows, const TestOptions& options);

/// Does a value carry over to the next? Autocorrelation at 1 row, permuted inside runs; effect: the
/// correlation.
Finding serial_test(const Series& residual, const TestOptions& options);

/// Is there a line in the spectrum (Lomb-Scargle, time in seconds)? The series is whitened first; effect:
/// amplitude of the line.
Finding periodic_test(const Series& residual, const std::vector<double>& time, const TestOptions& options);

/// More values beyond four robust deviations than a normal distribution has, on one side or both; effect: the
/// fraction. Wild values in a row count once.
Finding outlier_test(const Series& residual, const TestOptions& options);

/// Does the scatter grow or shrink with the level? Spearman's correlation of |residual|; effect: ratio of the
/// scatter in the highest fifth of levels to the lowest, minus 1.
Finding spread_test(const Series& residual, const std::vector<double>& level, std::string_view name,
                    const TestOptions& options);

/// Do some runs, or quarters of runs, scatter more than others? Brown and Forsythe's analysis of variance of
/// the distances from each stretch's median (J. Am. Stat. Assoc. 69, 1974), rows exchanged over all runs; for
/// innovations, which do not carry over. Effect: ratio of the widest to the narrowest, minus 1.
Finding evenness_test(const Series& residual, const TestOptions& options);

/// Does the run's place in the order of runs matter? A trend over run means; needs four runs.
Finding run_order_test(const Series& residual, const TestOptions& options);

/// Are there values repeated exactly in successive rows more often than chance makes them (old samples handed
/// out again)? `raw`: the measured values, not residuals. Effect: the fraction of repeats.
Finding held_test(const Series& raw, const TestOptions& options);

}  // namespace puckloop::gap::stats
