#include "gap/data/csv.h"

#include "base/csv.h"
#include "base/error.h"
#include "gap/data/problems.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <string_view>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostRows = 5'000'000;

/// The text with what is not UTF-8 as '?': files of another encoding are common, their numbers are fine.
std::string readable(std::string_view text) {
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        const auto lead = static_cast<unsigned char>(text[i]);
        const std::size_t length = lead < 0x80   ? 1
                                   : lead < 0xC2 ? 0
                                   : lead < 0xE0 ? 2
                                   : lead < 0xF0 ? 3
                                   : lead < 0xF5 ? 4
                                                 : 0;
        bool good = length > 0 && i + length <= text.size() && lead >= 0x20 && lead != 0x7F;
        for (std::size_t k = 1; good && k < length; ++k)
            good = (static_cast<unsigned char>(text[i + k]) & 0xC0) == 0x80;
        out += good ? std::string(text.substr(i, length)) : "?";
        i += good ? length : 1;
    }
    constexpr std::size_t kLongest = 40;
    if (out.size() > kLongest) {
        out.resize(kLongest);
        while (!out.empty() && (static_cast<unsigned char>(out.back()) & 0xC0) == 0x80)
            out.pop_back();
        if (!out.empty() && static_cast<unsigned char>(out.back()) >= 0xC2) out.pop_back();
        out += "...";
    }
    return out;
}

/// False for text that is no number.
bool parse(std::string_view cell, double& value) {
    value = std::numeric_limits<double>::quiet_NaN();
    if (cell.empty() || cell == "nan" || cell == "NaN" || cell == "NA" || cell == "null") return true;
    return csv_number(cell, value);
}

}  // namespace

CsvTable read_csv(const std::filesystem::path& file, Problems* problems) {
    // Pipes and devices may never end.
    std::error_code failed;
    const auto type = std::filesystem::status(file, failed).type();
    std::ifstream stream;
    if (type == std::filesystem::file_type::regular) stream.open(file, std::ios::binary);
    if (!stream.is_open())
        throw InputError(file.string(), "",
                         type == std::filesystem::file_type::regular ||
                                 type == std::filesystem::file_type::not_found
                             ? "cannot be opened"
                             : "is not a file",
                         "a CSV file with a header line");
    CsvTable table;
    char separator = ',';
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
        if (number == 1 && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        if (number == 1 && (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")))
            throw InputError(file.string(), "", "is UTF-16 text", "UTF-8 or plain ASCII");
        if (const auto inner = line.find('\r'); inner != std::string::npos && inner + 1 < line.size())
            throw InputError(file.string(), fmt::format("line {}", number),
                             "ends its lines with carriage returns only", "line feeds, with or without them");
        const std::string_view text = csv_trimmed(line);
        if (text.empty() || text.front() == '#') continue;
        const std::string place = fmt::format("line {}", number);
        if (table.names.empty()) {
            if (line.find(',') == std::string::npos)
                separator = line.find(';') != std::string::npos    ? ';'
                            : line.find('\t') != std::string::npos ? '\t'
                                                                   : ',';
            for (const auto cell : csv_cells(line, separator)) {
                double ignored = 0.0;
                if (!cell.empty() && parse(cell, ignored))
                    throw InputError(file.string(), place,
                                     fmt::format("has the number {} as a column's name", readable(cell)),
                                     "a header line with names");
                const std::string own = readable(cell);
                for (const auto& name : table.names)
                    if (name == own)
                        throw InputError(file.string(), place,
                                         fmt::format("names the column \"{}\" twice", own));
                table.names.push_back(own);
            }
            table.columns.resize(table.names.size());
            continue;
        }
        const auto cells = csv_cells(line, separator);
        const bool whole = attempt(problems, [&] {
            if (cells.size() != table.names.size())
                throw InputError(file.string(), place, fmt::format("has {} cells", cells.size()),
                                 fmt::format("{}, as the header", table.names.size()));
        });
        if (!whole) continue;
        for (std::size_t i = 0; i < cells.size(); ++i) {
            double value = 0.0;
            const bool sound = attempt(problems, [&] {
                if (!parse(cells[i], value) || std::isinf(value))
                    throw InputError(file.string(), place,
                                     fmt::format("\"{}\" in column \"{}\" is not a finite number",
                                                 readable(cells[i]), table.names[i]),
                                     cells[i].find(',') != std::string_view::npos
                                         ? "a decimal point, not a comma"
                                         : "a number, or nothing where it is missing");
            });
            table.columns[i].push_back(sound ? value : std::numeric_limits<double>::quiet_NaN());
        }
        if (table.rows() > kMostRows)
            throw InputError(file.string(), place, "is too long", fmt::format("at most {} rows", kMostRows));
    }
    if (table.names.empty()) throw InputError(file.string(), "", "is empty", "a header line and rows");
    if (table.rows() == 0) throw InputError(file.string(), "", "has no rows", "at least one");
    return table;
}

}  // namespace puckloop::gap
