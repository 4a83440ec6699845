#pragma once
// A CSV file of numbers with one header line: what experiment.toml names.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::gap {

class Problems;

struct CsvTable {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;  ///< NaN where a cell is empty, "nan" or "NA"
    std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// Comma, semicolon or tab between cells (as the header has it); empty lines and lines that begin with '#'
/// are passed over. Throws InputError with the line for text, infinities, and rows of another length.
/// Where `problems` are gathered, bad rows are left out, bad cells are missing, and reading goes on.
CsvTable read_csv(const std::filesystem::path& file, Problems* problems = nullptr);

}  // namespace puckloop::gap
