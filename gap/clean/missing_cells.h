#pragma once
// One sentence for the cells that a column lacks, however many files lack them.

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

/// The cells missing in one file.
struct MissingIn {
    std::string file;
    std::size_t missing = 0, rows = 0;
};

/// "run1.csv: x_m is missing in 4 of 155 rows, which are left out", of several files "x_m is missing in 38 of
/// 2987 rows (22 runs), which are left out; most in run08.csv: 4 of 155". Rows are those of the files given;
/// `so` is what becomes of them.
std::string missing_sentence(std::string_view column, const std::vector<MissingIn>& files,
                             std::string_view so);

}  // namespace puckloop::gap
