#pragma once
// Whole text files for commands, "-" meaning standard input or output.

#include <string>
#include <string_view>

namespace puckloop::tools {

/// Throws InputError: missing, a directory, unreadable, larger than 64 MB.
std::string read_text(const std::string& path);

/// Throws InputError when the file cannot be created, RunError when the disk is full.
void write_text(const std::string& path, std::string_view text);

}  // namespace puckloop::tools
