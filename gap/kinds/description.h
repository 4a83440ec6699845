#pragma once
// A kind of experiment that its user describes in a file (docs/gap_kinds.md), without a line of C++: its
// columns, what a simulator would say of each measured one as formulas, parameters and effects. Plain data;
// gap/kinds/read_kind reads it, gap/models/described predicts by it.

#include "gap/kinds/columns.h"
#include "gap/kinds/effect.h"
#include "gap/kinds/formula.h"
#include "gap/kinds/instrument.h"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// A number that a formula has: the simulator's, where it is neutral.
struct DescribedParameter {
    std::string name;  ///< in formulas; in verdicts "KIND.name"
    std::string unit;
    double neutral = 0.0;
    std::string per{};  ///< a column: one number for each of its values ("KIND.name0", ...); "": one number
    double low = 0.0, high = 0.0;  ///< where an effect frees it, or as far as it may be stated
    int line = 0;
};

/// A formula over the kind's variables: columns, then parameters, then formulas with a name.
struct DescribedFormula {
    std::string what;  ///< "formula near", "mean of column reading", for messages
    Formula formula;
    int line = 0;
};

/// What a simulator says of one measured column.
struct DescribedObservable {
    std::size_t column = 0;  ///< in Description::columns
    NoiseKind noise = NoiseKind::Carry;
    std::size_t mean = 0;                   ///< in Description::formulas, as the next two
    std::optional<std::size_t> factor, sd;  ///< noise is so many times larger; sd added in quadrature
    Instrument instrument{};

    /// Those of its formulas that there are.
    std::vector<std::size_t> formulas() const;
};

struct Description {
    std::string name;
    std::string title;           ///< one line
    std::filesystem::path file;  ///< where it was read

    std::vector<ColumnInfo> columns;  ///< its own in the file's order, then the common ones
    std::size_t own_columns = 0;
    std::map<std::size_t, double> absent;  ///< by column: the value where it is missing or absent
    std::string chain;                     ///< column whose values are series of their own; "": none
    std::vector<DescribedParameter> parameters;
    /// With a name first, each after those that it has; then those of the observables.
    std::vector<DescribedFormula> formulas;
    std::size_t named_formulas = 0;
    std::vector<DescribedObservable> observables;
    std::vector<Effect> effects;

    /// Place of the column of this name; nothing if there is none.
    std::optional<std::size_t> column(std::string_view name) const;
    /// Of all variables, in the order in which formulas number them.
    std::vector<std::string> variables() const;
    /// What a variable is: a place in columns, parameters or formulas.
    enum class Variable : std::uint8_t { Column, Parameter, Formula };
    std::pair<Variable, std::size_t> variable(std::size_t index) const;
    /// The variables that a formula has, those of the formulas in it among them; rising.
    std::vector<std::size_t> all_used(std::size_t formula) const;
    /// "KIND.name"
    std::string full_name(const DescribedParameter& parameter) const;

    std::vector<std::string> formula_names;  ///< of the first `named_formulas`
    std::deque<std::string> texts;           ///< what columns and effects point to
};

}  // namespace puckloop::gap
