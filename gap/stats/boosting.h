#pragma once
// A free-form correction of errors: step functions over cells of covariates and of pairs of them, added in
// small steps where they help most (componentwise boosting), and judged on runs that it did not see.
//
// Errors that carry over from row to row (first-order) are handled as generalised least squares does: error
// and correction are both freed of the share that is kept.

#include <cstdint>
#include <string>
#include <vector>

namespace puckloop::gap::stats {

/// Every row lies in one cell of a component.
struct Component {
    std::string name;                ///< "grey" or "sensor and grey"
    std::vector<std::string> where;  ///< a cell each, in words; "grey = 0.31"; may be empty
    std::vector<double> at;          ///< mean of the covariate in each cell, of an ordered component
    std::vector<int> cell;           ///< 0..cells-1; -1: unknown, no correction
    std::vector<double> weight;      ///< of the correction in a row; empty: 1
    int cells = 0;
    bool ordered = false;     ///< neighbouring cells are alike
    bool pair = false;        ///< cells of two covariates crossed
    std::string qualifier{};  ///< " (40 bins)", " (across the heading)": not part of a cell's words
};

/// Sums of `value(row)` over the rows of each cell.
template <class Value>
std::vector<double> sums_of_cells(const Component& component, const Value& value) {
    std::vector<double> sums(static_cast<std::size_t>(component.cells), 0.0);
    for (std::size_t i = 0; i < component.cell.size(); ++i)
        if (component.cell[i] >= 0) sums[static_cast<std::size_t>(component.cell[i])] += value(i);
    return sums;
}
/// Weight of a component's correction in a row.
inline double weight_of(const Component& component, std::size_t row) {
    return component.weight.empty() ? 1.0 : component.weight[row];
}

struct ErrorRows {
    std::vector<double> error;  ///< in units of the noise; NaN: left out
    std::vector<char> follows;  ///< 1: carries over from the row before it in this list
    std::vector<int> run;
    double carry = 0.0;   ///< share of the previous error kept, -1..1
    bool trimmed = true;  ///< errors beyond four deviations are pulled in
};

struct Boosted {
    /// Log score that held-out rows win, nats: a run each (or a stretch, where runs are few).
    std::vector<double> gains;
    double carry = 0.0;              ///< that goes best with the correction
    std::vector<double> correction;  ///< a row each, in the error's unit; 0 where nothing is there
    std::vector<double> weight;      ///< a component each: variance of its part of the correction
};

Boosted boosted(const ErrorRows& rows, const std::vector<Component>& components, std::uint64_t seed);

}  // namespace puckloop::gap::stats
