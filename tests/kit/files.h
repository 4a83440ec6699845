#pragma once
// What a test reads back.

#include <filesystem>
#include <string>

namespace puckloop::tests {

/// All that is in the file, nothing where there is none.
std::string text_of(const std::filesystem::path& file);

}  // namespace puckloop::tests
