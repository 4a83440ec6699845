#pragma once
// Numbers that a quantity can have, but hardly has in this unit: metres taken for millimetres or the reverse.

#include "gap/data/columns.h"
#include "gap/data/experiment.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// The unit in which a column's numbers, as the files have them, would come out near `expected`, where they
/// came out at `found` (SI, both above 0, typical or largest values); empty where none brings them nearer
/// than a factor of five.
std::string_view likely_unit(const Experiment& experiment, const ColumnInfo& info, double found,
                             double expected);

/// "run1.csv" or "run1.csv and 5 more files": those that have the column.
std::string files_with(const Experiment& experiment, std::string_view column);

/// What to do where columns are likely in this unit: "if the files' numbers are in cm, state ... in
/// [columns]".
std::string to_state(const Experiment& experiment, const std::vector<std::string_view>& columns,
                     std::string_view unit);

/// What to do about an impossible value of this column (SI): "; numbers in mm need ...", or nothing.
std::string unit_remedy(const Experiment& experiment, const ColumnInfo& info, double value);

/// A caution for each column whose values lie far outside what a robot, its sensors and an arena have, or
/// that is at odds with another column of the same experiment by what only a wrong unit makes.
void check_units(Experiment& experiment);

/// Of a motion experiment: the way and the heading that the tracker saw against what the wheels were asked.
void check_motion_units(Experiment& experiment);

}  // namespace puckloop::gap
