#include "gap/csv.h"

#include "base/error.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostRows = 5'000'000;

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r\"");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r\"") - first + 1);
}

std::vector<std::string_view> cells_of(std::string_view line, char separator) {
    std::vector<std::string_view> cells;
    for (;;) {
        const auto end = line.find(separator);
        cells.push_back(trimmed(line.substr(0, end)));
        if (end == std::string_view::npos) return cells;
        line.remove_prefix(end + 1);
    }
}

/// False for text that is no number.
bool parse(std::string_view cell, double& value) {
    value = std::numeric_limits<double>::quiet_NaN();
    if (cell.empty() || cell == "nan" || cell == "NaN" || cell == "NA" || cell == "null") return true;
    if (cell.front() == '+') cell.remove_prefix(1);
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return error == std::errc() && end == cell.data() + cell.size();
}

}  // namespace

CsvTable read_csv(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream || std::filesystem::is_directory(file))
        throw InputError(file.string(), "", "cannot be opened", "a CSV file with a header line");
    CsvTable table;
    char separator = ',';
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        const std::string_view text = trimmed(line);
        if (text.empty() || text.front() == '#') continue;
        const std::string place = fmt::format("line {}", number);
        if (table.names.empty()) {
            if (line.find(',') == std::string::npos)
                separator = line.find(';') != std::string::npos    ? ';'
                            : line.find('\t') != std::string::npos ? '\t'
                                                                   : ',';
            for (const auto cell : cells_of(line, separator)) {
                double ignored = 0.0;
                if (!cell.empty() && parse(cell, ignored))
                    throw InputError(file.string(), place,
                                     fmt::format("has the number {} as a column's name", cell),
                                     "a header line with names");
                for (const auto& name : table.names)
                    if (name == cell)
                        throw InputError(file.string(), place,
                                         fmt::format("names the column \"{}\" twice", cell));
                table.names.emplace_back(cell);
            }
            table.columns.resize(table.names.size());
            continue;
        }
        const auto cells = cells_of(line, separator);
        if (cells.size() != table.names.size())
            throw InputError(file.string(), place, fmt::format("has {} cells", cells.size()),
                             fmt::format("{}, as the header", table.names.size()));
        for (std::size_t i = 0; i < cells.size(); ++i) {
            double value = 0.0;
            if (!parse(cells[i], value) || std::isinf(value))
                throw InputError(
                    file.string(), place,
                    fmt::format("\"{}\" in column \"{}\" is not a finite number", cells[i], table.names[i]),
                    "a number, or nothing where it is missing");
            table.columns[i].push_back(value);
        }
        if (table.rows() > kMostRows)
            throw InputError(file.string(), place, "is too long", fmt::format("at most {} rows", kMostRows));
    }
    if (table.names.empty()) throw InputError(file.string(), "", "is empty", "a header line and rows");
    if (table.rows() == 0) throw InputError(file.string(), "", "has no rows", "at least one");
    return table;
}

}  // namespace puckloop::gap
