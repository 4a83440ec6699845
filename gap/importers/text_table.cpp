#include "gap/importers/text_table.h"

#include "base/error.h"
#include "base/text/csv.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include <algorithm>
#include <cmath>
#include <fstream>

namespace puckloop::gap::importers {

std::vector<TextRow> read_rows(const std::filesystem::path& file, char separator) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file))
        throw InputError(file.string(), "", "cannot be opened", "a table of numbers");
    std::vector<TextRow> rows;
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
        const auto cells = csv_cells(line, separator);
        TextRow row{number, {cells.begin(), cells.end()}};
        if (std::any_of(row.cells.begin(), row.cells.end(), [](const auto& c) { return !c.empty(); }))
            rows.push_back(std::move(row));
    }
    if (rows.empty()) throw InputError(file.string(), "", "is empty", "rows of numbers");
    return rows;
}

double number_in(const std::filesystem::path& file, const TextRow& row, std::size_t cell) {
    double value = 0.0;
    const std::string& text = cell < row.cells.size() ? row.cells[cell] : std::string();
    if (!csv_number(text, value) || !std::isfinite(value))
        throw InputError(file.string(), fmt::format("line {}", row.line),
                         fmt::format("has \"{}\" in column {}", text.substr(0, 40), cell + 1),
                         "a finite number");
    return value;
}

std::vector<std::vector<double>> read_numbers(const std::filesystem::path& file, char separator,
                                              std::size_t columns, std::size_t header_rows) {
    const std::vector<TextRow> rows = read_rows(file, separator);
    std::vector<std::vector<double>> table(columns);
    for (std::size_t r = header_rows; r < rows.size(); ++r) {
        if (rows[r].cells.size() != columns)
            throw InputError(file.string(), fmt::format("line {}", rows[r].line),
                             fmt::format("has {} cells", rows[r].cells.size()), fmt::format("{}", columns));
        for (std::size_t c = 0; c < columns; ++c)
            table[c].push_back(number_in(file, rows[r], c));
    }
    if (table.empty() || table.front().empty())
        throw InputError(file.string(), "", "has a header only", "rows of numbers");
    return table;
}

std::vector<std::filesystem::path> paths_like(const std::filesystem::path& folder,
                                              const std::filesystem::path& pattern) {
    std::vector<std::filesystem::path> found{folder};
    for (const auto& name : pattern) {
        std::vector<std::filesystem::path> deeper;
        for (const auto& parent : found) {
            if (!std::filesystem::is_directory(parent)) continue;
            for (const auto& entry : std::filesystem::directory_iterator(parent))
                if (fnmatch(name.c_str(), entry.path().filename().c_str(), FNM_EXTMATCH) == 0)
                    deeper.push_back(entry.path());
        }
        found = std::move(deeper);
    }
    std::sort(found.begin(), found.end());
    return found;
}

}  // namespace puckloop::gap::importers
