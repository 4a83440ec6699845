#pragma once
// Numbers that a quantity can have, but hardly has in this unit: metres taken for millimetres or the reverse.

#include "gap/data/columns.h"
#include "gap/data/experiment.h"

#include <string>

namespace puckloop::gap {

/// What to do about an impossible value of this column (SI): "; numbers in mm need ...", or nothing.
std::string unit_remedy(const Experiment& experiment, const ColumnInfo& info, double value);

/// A caution for each column whose values lie far outside what a robot, its sensors and an arena have, or
/// that is at odds with another column of the same experiment, where another unit puts it right.
void check_units(Experiment& experiment);

}  // namespace puckloop::gap
