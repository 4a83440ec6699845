#pragma once
// The structure tests of one observable's residual against everything the experiment knows: its own columns,
// the conditions of its runs, what follows from commands and steps (speed, turn rate, acceleration, distance
// so far), time, order, sessions.

#include "gap/data/experiment.h"
#include "gap/findings/findings.h"
#include "gap/stats/structure.h"

namespace puckloop::gap {

enum class Stage { Before, After };  ///< of the simulator as it is, or with the chosen effects

/// What the simulator gives in each row at that stage.
const std::vector<double>& simulated(const Series& series, Stage stage);
/// Measured - simulated; NaN where nothing was simulated.
std::vector<double> left_over(const Series& series, Stage stage);

/// The residual that is looked at: standardised innovations where the series has them, else what is
/// left over.
std::vector<double> residual_of(const Series& series, Stage stage);

/// A covariate a row of the series; only those that vary.
std::vector<stats::Covariate> covariates_of(const Experiment& experiment, const Series& series);

/// A column's name as reports have it: "distance" for "distance_m".
std::string plain_name(std::string name);

/// Time a row (t_s or the kind's clock); row numbers where there is none.
std::vector<double> times_of(const Experiment& experiment, const Series& series);

/// All tests, corrected together by Holm over this observable. Effects are in the residual's unit.
std::vector<stats::Finding> residual_structure(const Experiment& experiment, const Series& series,
                                               Stage stage, const stats::TestOptions& options);

}  // namespace puckloop::gap
