#pragma once
// Numbers that a quantity can have, but hardly has in this unit: metres taken for millimetres or the reverse.

#include "gap/kinds/columns.h"
#include "gap/data/experiment.h"

#include <cmath>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

constexpr double kFar = 4.0;  ///< factor between two columns that no effect makes

/// What a column should be beside what it is; offsets count for nothing.
struct Pairs {
    std::vector<double> expected, seen;

    void add(double one, double other) {
        if (std::isfinite(one + other)) expected.push_back(one), seen.push_back(other);
    }
    /// Both ways, so that the mean is 0, of what has no offset.
    void add_both(double one, double other) { add(one, other), add(-one, -other); }
    /// How many times as much one changes as the other; NaN where they hardly go together.
    double factor(double together = 0.7) const;
    /// How many times as large one is as the other in the middle row, zeros left out; NaN where they hardly
    /// go together.
    double ratio() const;
    /// Share of the rows, zeros left out, in which both go the same way, or in which they do not if that is
    /// more: 0.5 to 1; 0 without rows.
    double agreement() const;
    /// Only those with the largest of what is seen, or only with the smallest.
    Pairs part(bool large) const;
};

/// What to do about an impossible value of this column (SI): "; numbers in mm need ...", or nothing.
std::string unit_remedy(const Experiment& experiment, const ColumnInfo& info, double value);

/// A column of a product, and its power there.
struct Factor {
    std::string column;
    int power = 1;
};

/// A caution where the first column changes less than a quarter or more than `high` times as much as expected
/// (by `factor`), and another unit of one of them puts that right.
void ask_factor(Experiment& experiment, const std::vector<Factor>& factors, std::string_view other,
                double factor, double high = kFar);

/// A caution for each column whose values lie far outside what a robot, its sensors and an arena have, or
/// that is at odds with another column of the same experiment, where another unit puts it right.
void check_units(Experiment& experiment);

}  // namespace puckloop::gap
