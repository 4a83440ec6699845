#include "gap/data/csv.h"

#include "base/error.h"
#include "base/text/csv.h"
#include "gap/data/problems.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puckloop::gap {

namespace {

constexpr std::size_t kMostRows = 5'000'000;
constexpr const char* kHeader = "header";

/// The text with what is not UTF-8 as '?': files of another encoding are common, their numbers are fine.
std::string readable(std::string_view text) {
    constexpr std::size_t kLongest = 40;
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
        const std::string_view next = good ? text.substr(i, length) : "?";
        if (out.size() + next.size() > kLongest) return out + "...";
        out += next;
        i += next.size();
    }
    return out;
}

/// Could the commas in a column's cells part thousands from hundreds, not fractions?
struct Commas {
    bool any = false, thousands = true;

    void take(std::string_view cell) {
        const auto figures = cell.substr(std::min(cell.find_first_not_of("+-"), cell.size()));
        const auto comma = figures.find(',');
        const auto before = figures.substr(0, comma);
        if (comma == std::string_view::npos)
            thousands = thousands && before.size() <= 3;
        else
            thousands =
                thousands && figures.size() == comma + 4 && comma >= 1 && comma <= 3 && before.front() != '0';
        any = any || comma != std::string_view::npos;
    }
};

/// How a file writes its fractions: with one or the other throughout.
enum class Decimal { Unknown, Point, Comma };

/// False for text that is no number. A comma inside a cell, between other separators or in quotes, is a
/// decimal comma.
bool parse(std::string_view cell, Decimal& decimal, double& value) {
    value = std::numeric_limits<double>::quiet_NaN();
    if (cell.empty() || cell == "nan" || cell == "NaN" || cell == "NA" || cell == "null") return true;
    const auto comma = cell.find(',');
    const Decimal own = comma != std::string_view::npos            ? Decimal::Comma
                        : cell.find('.') != std::string_view::npos ? Decimal::Point
                                                                   : Decimal::Unknown;
    std::string text(cell);
    if (own == Decimal::Comma) text[comma] = '.';
    if (!csv_number(text, value) || std::isinf(value)) return false;
    if (own == Decimal::Unknown) return true;
    if (decimal == Decimal::Unknown) decimal = own;
    return decimal == own;
}

constexpr const char* kWanted = "a CSV file: a header line, then rows of numbers";

/// What programs write that is not CSV, by its first bytes and by what no text holds.
void refuse_binary(const std::filesystem::path& file, const std::string& place, std::string_view line) {
    if (place == kHeader && (line.starts_with("\xFF\xFE") || line.starts_with("\xFE\xFF")))
        throw InputError(file.string(), "", "is UTF-16 text", "UTF-8 or plain ASCII");
    if (place == kHeader && line.starts_with("PK\x03\x04"))
        throw InputError(file.string(), "", "is a spreadsheet or an archive, not text",
                         "the sheet saved as CSV");
    if (is_binary(line)) throw InputError(file.string(), place, "is binary, not text", kWanted);
    if (const auto inner = line.find('\r'); inner != std::string_view::npos && inner + 1 < line.size())
        throw InputError(file.string(), place, "ends its lines with carriage returns only",
                         "line feeds, with or without them");
}

char separator_of(std::string_view header) {
    for (const char separator : {',', ';', '\t'})
        if (csv_cells(header, separator).size() > 1) return separator;
    return ',';
}

/// Lines that are quoted as a whole are one cell each.
void refuse_quoted_line(const std::filesystem::path& file, std::string_view header) {
    const auto cells = csv_cells(header, ',');
    if (cells.size() == 1 && header.starts_with('"') && cells.front().find(',') != std::string_view::npos)
        throw InputError(file.string(), kHeader, "is one quoted cell with separators in it",
                         "each name and number as a cell of its own, without quotes about whole lines");
}

void read_header(const std::filesystem::path& file, std::string_view line, char separator, CsvTable& table) {
    for (const auto cell : csv_cells(line, separator)) {
        double ignored = 0.0;
        Decimal decimal = Decimal::Unknown;
        if (!cell.empty() && parse(cell, decimal, ignored))
            throw InputError(file.string(), kHeader,
                             fmt::format("has the number {} as a column's name", readable(cell)),
                             "a header line with names");
        const std::string own = readable(cell);
        if (std::find(table.names.begin(), table.names.end(), own) != table.names.end())
            throw InputError(file.string(), kHeader, fmt::format("names the column \"{}\" twice", own),
                             "each column once");
        table.names.push_back(own);
    }
    table.columns.resize(table.names.size());
}

/// A cell that goes on in the next line, or a quote too many.
const char* open_quote(std::string_view line) {
    return std::count(line.begin(), line.end(), '"') % 2 == 0 ? ""
                                                              : ", and a quote that its line does not close";
}

/// What to do about a cell that is no number.
const char* remedy(std::string_view cell) {
    const bool figures = cell.find_first_not_of("+-0123456789.,' ") == std::string_view::npos &&
                         cell.find_first_of(".,'") != std::string_view::npos;
    return figures
               ? "one decimal point throughout, or with ; or tab between cells one decimal comma; nothing "
                 "between thousands"
               : "a number, or nothing where it is missing";
}

}  // namespace

std::ifstream opened(const std::filesystem::path& file, const char* wanted) {
    using enum std::filesystem::file_type;
    std::error_code failed;
    const auto type = std::filesystem::status(file, failed).type();
    std::ifstream stream;
    if (type == regular) stream.open(file, std::ios::binary);
    if (stream.is_open()) return stream;
    throw InputError(file.string(), "",
                     type == not_found                 ? "is not there"
                     : type == directory               ? "is a folder, not a file"
                     : type == regular || type == none ? "cannot be opened"
                                                       : "is a pipe or device, which may never end",
                     wanted);
}

bool is_binary(std::string_view text) {
    return std::any_of(text.begin(), text.end(), [](char c) { return c >= 0 && c < '\t'; });
}

CsvTable read_csv(const std::filesystem::path& file, Problems& problems) {
    std::ifstream stream = opened(file, kWanted);
    CsvTable table;
    char separator = ',';
    Decimal decimal = Decimal::Unknown;
    std::vector<Commas> commas;
    for (std::string line; std::getline(stream, line);) {
        const bool first = table.names.empty();
        if (first && line.starts_with("\xEF\xBB\xBF")) line.erase(0, 3);
        const std::string place = first ? kHeader : fmt::format("row {}", table.rows() + 1);
        refuse_binary(file, place, line);
        const std::string_view text = csv_trimmed(line);
        if (text.empty() || text.front() == '#') continue;
        if (first) {
            separator = separator_of(line);
            refuse_quoted_line(file, line);
            if (text.find(separator) == std::string_view::npos && text.find(' ') != std::string_view::npos)
                throw InputError(file.string(), kHeader, "has only blanks between names",
                                 "a comma, semicolon or tab");
            read_header(file, line, separator, table);
            commas.resize(table.names.size());
            continue;
        }
        auto cells = csv_cells(line, separator);
        const bool whole = problems.attempt([&] {
            if (cells.size() != table.names.size())
                throw InputError(file.string(), place,
                                 fmt::format("has {} cells{}", cells.size(), open_quote(line)),
                                 fmt::format("{}, as the header{}", table.names.size(),
                                             separator == ',' && cells.size() > table.names.size()
                                                 ? "; with decimal commas, semicolons between cells"
                                                 : ""));
        });
        if (!whole) cells.assign(table.names.size(), {});  // the rows behind it keep their numbers
        for (std::size_t i = 0; i < cells.size(); ++i) {
            double value = 0.0;
            commas[i].take(cells[i]);
            const bool sound = problems.attempt([&] {
                if (!parse(cells[i], decimal, value))
                    throw InputError(file.string(), place,
                                     fmt::format("\"{}\" in column \"{}\" is not a finite number",
                                                 readable(cells[i]), table.names[i]),
                                     remedy(cells[i]));
            });
            table.columns[i].push_back(sound ? value : std::numeric_limits<double>::quiet_NaN());
        }
        if (table.rows() > kMostRows)
            throw InputError(file.string(), place, "is too long", fmt::format("at most {} rows", kMostRows));
    }
    if (table.names.empty()) throw InputError(file.string(), "", "is empty", kWanted);
    if (table.rows() == 0)
        throw InputError(file.string(), "", "has no rows", "at least one below the header");
    table.decimal_commas = decimal == Decimal::Comma;
    for (std::size_t i = 0; table.decimal_commas && i < commas.size(); ++i) {
        if (!commas[i].any || !commas[i].thousands) continue;
        // Between commas a quoted "1,200" is as likely 1200 as 1.2, where no number of its column shows
        // which: programs that group thousands do so beside columns with decimals.
        if (separator == ',')
            throw InputError(file.string(), "",
                             fmt::format("column \"{}\" has three digits behind every comma: thousands or "
                                         "decimals (\"1,200\" is 1200 or 1.2)?",
                                         table.names[i]),
                             "nothing between thousands, and a decimal point");
        table.like_thousands.push_back(table.names[i]);
    }
    return table;
}

}  // namespace puckloop::gap
