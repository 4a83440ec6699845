#pragma once
// Readings repeated at one placement share its error. Is that error larger than the repeats' scatter?

#include "gap/data/experiment.h"
#include "gap/findings/findings.h"

#include <string>

namespace puckloop::gap {

/// What a structure of placements is called among the covariates.
inline constexpr const char* kPlacementCovariate = "placement";

/// "differs from placement to placement by ..." if what is left (after) does so by more than repeats scatter
/// at one placement; empty if not, or if there are fewer than six placements with ten rows each on average.
std::string placement_shape(const Experiment& experiment, const Series& series);

/// The same as a caution for the verdict.
std::string placement_caution(const Experiment& experiment, const Series& series);

/// A sentence if the simulator as it is says every row to a millionth of the spread: its numbers come from
/// this data.
std::string circular_caution(const Series& series);

}  // namespace puckloop::gap
