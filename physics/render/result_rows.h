#pragma once
// Rows of a file that a run left: a run that died may have left half of the last one.

#include <filesystem>
#include <functional>
#include <string_view>
#include <vector>

namespace puckloop::physics {

/// Calls take(cells) for each row after the header; it gives false for what is none. Such a last line is
/// ignored, one elsewhere or a missing file throws RunError: "... not a row of `what`".
void for_each_result_row(const std::filesystem::path& file, std::string_view what,
                         const std::function<bool(const std::vector<std::string_view>& cells)>& take);

}  // namespace puckloop::physics
