#pragma once
// Cells of a column that nobody filled in are NaN.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <vector>

namespace puckloop::gap {

inline bool missing(double value) {
    return std::isnan(value);
}

/// The values that are there, in their order.
inline std::vector<double> known(const std::vector<double>& values) {
    std::vector<double> there;
    std::remove_copy_if(values.begin(), values.end(), std::back_inserter(there), missing);
    return there;
}

inline std::size_t count_missing(const std::vector<double>& values) {
    return static_cast<std::size_t>(std::count_if(values.begin(), values.end(), missing));
}

}  // namespace puckloop::gap
