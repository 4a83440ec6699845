#include "physics/render/result_rows.h"

#include "base/error.h"
#include "base/text/csv.h"

#include <fmt/format.h>

#include <fstream>
#include <string>

namespace puckloop::physics {

void for_each_result_row(const std::filesystem::path& file, std::string_view what,
                         const std::function<bool(const std::vector<std::string_view>& cells)>& take) {
    std::ifstream in(file);
    if (!in) throw RunError(fmt::format("cannot read {}", file.string()));
    std::string line;
    std::getline(in, line);  // header
    for (int number = 2; std::getline(in, line); ++number) {
        if (take(csv_cells(line, ','))) continue;
        if (in.peek() == std::ifstream::traits_type::eof()) return;
        throw RunError(fmt::format("{}: line {}: not a row of {}", file.string(), number, what));
    }
}

}  // namespace puckloop::physics
