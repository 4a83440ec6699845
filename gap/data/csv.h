#pragma once
// A CSV file of numbers with one header line: what experiment.toml names.

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>
#include <vector>

namespace puckloop::gap {

class Problems;

struct CsvTable {
    std::vector<std::string> names;
    std::vector<std::vector<double>> columns;   ///< NaN where a cell is empty, "nan" or "NA"
    bool decimal_commas = false;                ///< "0,5" was read as 0.5
    std::vector<std::string> like_thousands{};  ///< columns whose "1,200", read as 1.2, may have been 1200
    std::size_t rows() const { return columns.empty() ? 0 : columns.front().size(); }
};

/// InputError, which names what is `wanted`, where there is no file that ends: pipes and devices may not.
std::ifstream opened(const std::filesystem::path& file, const char* wanted);

/// Holds a control character that no text has.
bool is_binary(std::string_view text);

/// Comma, semicolon or tab between cells (as the header has it); empty lines and lines that begin with '#'
/// are passed over. Between semicolons or tabs, and in quotes, a comma is a decimal comma, if no number has a
/// point; in quotes between commas one of them at least must not look like thousands.
/// InputErrors name the row (from 1 after the header): text, infinities, and rows of another length.
/// Bad rows and bad cells go to `problems`; their cells are missing, and reading goes on.
CsvTable read_csv(const std::filesystem::path& file, Problems& problems);

}  // namespace puckloop::gap
