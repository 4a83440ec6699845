#pragma once
// Files of results: written whole or not at all.

#include <filesystem>
#include <string>

namespace puckloop::jobs {

/// Through FILE.part, so that a kill leaves the old file or the new one. RunError.
void write_whole(const std::filesystem::path& file, const std::string& text);

/// A cell of a CSV file, in quotes where it has to be (RFC 4180).
std::string csv_cell(const std::string& text);

}  // namespace puckloop::jobs
