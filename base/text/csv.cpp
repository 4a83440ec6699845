#include "base/text/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace puckloop {

namespace {

constexpr std::string_view kBlank = " \t\r\n\"";

/// Where the cell at the front of `line` ends: behind its closing quote where it begins with one (RFC 4180;
/// two quotes are one of the text), at the next separator else.
std::size_t cell_end(std::string_view line, char separator) {
    std::size_t at = line.find_first_not_of(' ');
    if (at == std::string_view::npos || line[at] != '"') return line.find(separator);
    for (++at; (at = line.find('"', at)) != std::string_view::npos; at += 2)
        if (at + 1 >= line.size() || line[at + 1] != '"') return line.find(separator, at);
    return std::string_view::npos;
}

}  // namespace

std::string_view csv_trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(kBlank);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::vector<std::string_view> csv_cells(std::string_view line, char separator) {
    std::vector<std::string_view> cells;
    if (separator == ' ') {
        for (std::size_t at = line.find_first_not_of(kBlank); at != std::string_view::npos;) {
            const auto end = std::min(line.find_first_of(kBlank, at), line.size());
            cells.push_back(line.substr(at, end - at));
            at = line.find_first_not_of(kBlank, end);
        }
        return cells;
    }
    for (;;) {
        const auto end = cell_end(line, separator);
        cells.push_back(csv_trimmed(line.substr(0, end)));
        if (end == std::string_view::npos) return cells;
        line.remove_prefix(end + 1);
    }
}

bool csv_number(std::string_view cell, double& value) {
    if (!cell.empty() && cell.front() == '+') cell.remove_prefix(1);
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    return !cell.empty() && error == std::errc() && end == cell.data() + cell.size();
}

std::string csv_text(std::span<const CsvColumn> columns, int digits) {
    std::string text;
    for (std::size_t c = 0; c < columns.size(); ++c)
        text += fmt::format("{}{}", c == 0 ? "" : ",", columns[c].name);
    text += '\n';
    const std::size_t rows = columns.empty() ? 0 : columns.front().values.size();
    for (std::size_t row = 0; row < rows; ++row) {
        for (std::size_t c = 0; c < columns.size(); ++c) {
            if (c > 0) text += ',';
            const double value = columns[c].values[row];
            if (std::isnan(value)) continue;
            if (digits > 0)
                text += fmt::format("{:.{}g}", value, digits);
            else
                text += fmt::format("{}", value);
        }
        text += '\n';
    }
    return text;
}

}  // namespace puckloop
