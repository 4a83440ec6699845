#pragma once
// Rows, or whole runs, that are copies of one another: a table whose "measurements" were pasted.

#include <string>
#include <vector>

namespace puckloop::gap::stats {

/// The measured columns of one run (or table); keys are what was set (distance, angle, time).
struct MeasuredRun {
    std::string name;
    std::vector<std::vector<double>> measured;  ///< one vector a column, equal lengths
    std::vector<std::vector<double>> keys;      ///< likewise
};

struct Copy {
    std::size_t run_a = 0, row_a = 0, run_b = 0, row_b = 0;  ///< first rows of both
    std::size_t rows = 1;                                    ///< how many rows in sequence are the same
    double bits = 0.0;  ///< information in the copied values: two independent measurements agree with 2^-bits
};

/// Copies that chance does not explain. A value's information is log2(spread / quantum) of its column: the
/// spread of differences between successive rows over its quantum: the decimal place it is
/// written to, or the smallest difference between distinct values where values recur. Values that many
/// rows share carry log2(1 / their share) at most; zeros and rows equal to the row before carry none. Rows
/// with the same keys that follow each other in one run are held samples, not copies, and are left out.
/// Reported when the bits exceed those that all pairs of rows could reach by chance once in a thousand
/// tables.
std::vector<Copy> copies_in(const std::vector<MeasuredRun>& runs);

}  // namespace puckloop::gap::stats
