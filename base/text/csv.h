#pragma once
// Tables of numbers as text: a line's cells, a cell's number, columns written out. What a file's header and
// rows have to be is for each reader to say.

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop {

/// Without white space, carriage returns and double quotes at both ends.
std::string_view csv_trimmed(std::string_view text);

/// Cells of one line, each trimmed. A separator inside quotes belongs to its cell (RFC 4180; a quoted cell
/// ends with its line at the latest, and two quotes inside stay two). With ' ' any run of white space
/// separates and there are no empty cells.
std::vector<std::string_view> csv_cells(std::string_view line, char separator);

/// A decimal number, with a leading '+' allowed; false for anything else, an empty cell too.
bool csv_number(std::string_view cell, double& value);

struct CsvColumn {
    std::string_view name;
    std::span<const double> values;
};

/// Header and rows, comma between; NaN is an empty cell, other values have `digits` significant digits (0: as
/// many as bring the same double back). All columns have the length of the first.
std::string csv_text(std::span<const CsvColumn> columns, int digits = 0);

}  // namespace puckloop
