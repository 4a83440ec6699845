#pragma once
// Reading other people's tables: rows of numbers with commas or blanks between them, no fixed header.

#include <filesystem>
#include <string>
#include <vector>

namespace puckloop::gap::importers {

struct TextRow {
    int line = 0;                    ///< in the file, from 1
    std::vector<std::string> cells;  ///< white space round them removed
};

/// Lines with at least one cell that is not empty. `separator` ' ' means any run of blanks. Throws InputError
/// when the file cannot be opened or has no such line.
std::vector<TextRow> read_rows(const std::filesystem::path& file, char separator);

/// A cell as a finite number, or InputError naming file, line and column.
double number_in(const std::filesystem::path& file, const TextRow& row, std::size_t cell);

/// A file of numbers, each row with exactly `columns` cells; `header_rows` lines are passed over first. The
/// result is one vector a column.
std::vector<std::vector<double>> read_numbers(const std::filesystem::path& file, char separator,
                                              std::size_t columns, std::size_t header_rows = 0);

/// Files and folders below `folder` that a pattern fits, sorted: "circular/*/*_metadata.csv".
std::vector<std::filesystem::path> paths_like(const std::filesystem::path& folder,
                                              const std::filesystem::path& pattern);

}  // namespace puckloop::gap::importers
