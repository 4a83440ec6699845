#include "gap/clean/missing_cells.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::gap {

std::string missing_sentence(std::string_view column, const std::vector<MissingIn>& files,
                             std::string_view so) {
    if (files.empty()) return {};
    if (files.size() == 1)
        return fmt::format("{}: {} is missing in {} of {} rows, {}", files[0].file, column, files[0].missing,
                           files[0].rows, so);
    std::size_t missing = 0, rows = 0;
    for (const MissingIn& file : files) {
        missing += file.missing;
        rows += file.rows;
    }
    const auto [least, most] =
        std::minmax_element(files.begin(), files.end(),
                            [](const MissingIn& a, const MissingIn& b) { return a.missing < b.missing; });
    return fmt::format("{} is missing in {} of {} rows ({} runs), {}{}", column, missing, rows, files.size(),
                       so,
                       least->missing == most->missing
                           ? ""
                           : fmt::format("; most in {}: {} of {}", most->file, most->missing, most->rows));
}

}  // namespace puckloop::gap
