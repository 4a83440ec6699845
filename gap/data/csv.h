#pragma once
// A CSV file of numbers with one header line: what experiment.toml names.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

class Problems;

struct CsvTable {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;  ///< NaN where a cell is empty, "nan" or "NA"
    bool decimal_commas = false;               ///< "0,5" was read as 0.5
    std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Holds a control character that no text has.
bool is_binary(std::string_view text);

/// Comma, semicolon or tab between cells (as the header has it); empty lines and lines that begin with '#'
/// are passed over. Between semicolons or tabs a comma is a decimal comma, if no number has a point.
/// Throws InputError with the row (from 1 after the header) for text, infinities, and rows of another length.
/// Where `problems` are gathered, the cells of bad rows and bad cells are missing, and reading goes on.
CsvTable read_csv(const std::filesystem::path& file, Problems* problems = nullptr);

}  // namespace puckloop::gap
