#pragma once
// Whole text files for commands, "-" meaning standard input or output, and the folder for results.

#include <filesystem>
#include <string>
#include <string_view>

namespace puckloop::tools {

/// Throws InputError: missing, a directory, unreadable, larger than 64 MB.
std::string read_text(const std::string& path);

/// Throws InputError when the file cannot be created, RunError when the disk is full.
void write_text(const std::string& path, std::string_view text);

/// The folder of --out, with those above it. Throws InputError when it cannot be made.
void make_out_folder(const std::filesystem::path& folder);

}  // namespace puckloop::tools
