#pragma once
// Files of text that are written whole.

#include <filesystem>
#include <string_view>

namespace puckloop {

/// RunError where the file cannot be written.
void write_file(const std::filesystem::path& file, std::string_view text);
/// With those above it. RunError where that fails.
void make_folder(const std::filesystem::path& folder);

}  // namespace puckloop
