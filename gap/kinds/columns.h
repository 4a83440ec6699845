#pragma once
// The canonical columns of each kind of experiment: names, units, what they are for, what is plausible.

#include "gap/kinds/kind.h"

#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

enum class Role {
    Observable,  ///< what the simulation must explain
    Truth,       ///< where things really were, or when; never missing as a whole
    Stimulus,    ///< what was commanded or set up
    Covariate,   ///< what else was noted: residuals are looked at against it
};

struct ColumnInfo {
    const char* name;
    const char* unit;  ///< SI unit of the column; "counts" and "1" are dimensionless
    Role role;
    bool required;
    double low, high;  ///< plausible values; outside them a unit or a column is wrong
    const char* meaning;
    double usual_low = 0.0, usual_high = INFINITY;  ///< of its largest sizes; `t_s`: of the step between rows
    bool index = false;  ///< of a described kind: numbers things (sensors, objects); whole
};

/// Columns of one kind, its own first, then those common to all kinds.
/// The kind must outlive what is returned, where it is a described one.
std::span<const ColumnInfo> columns_of(const Kind& kind);
/// nullptr if the kind has no such column.
const ColumnInfo* find_column(const Kind& kind, std::string_view name);

/// Those common to all kinds.
std::span<const ColumnInfo> common_columns();

/// " counts", " per kg"; "" for pure numbers.
std::string unit_suffix(std::string_view unit);

/// value_si = value * factor + offset
struct ToSi {
    double factor = 1.0, offset = 0.0;
};
/// From `unit` to the SI unit `si`; nothing if they do not measure the same thing or one is unknown.
std::optional<ToSi> unit_to_si(std::string_view unit, std::string_view si);

/// Is it a unit that columns can be turned into? Of others nothing is known.
bool is_column_unit(std::string_view si);

/// The names of all units that are turned into `si`.
std::vector<std::string_view> unit_names(std::string_view si);

}  // namespace puckloop::gap
