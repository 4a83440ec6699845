#pragma once
// Files of text that are read and written whole.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace puckloop {

/// All that is in the file; none where it cannot be opened.
std::optional<std::string> read_whole_file(const std::filesystem::path& file);
/// RunError where the file cannot be written.
void write_file(const std::filesystem::path& file, std::string_view text);
/// With those above it. RunError where that fails.
void make_folder(const std::filesystem::path& folder);

}  // namespace puckloop
