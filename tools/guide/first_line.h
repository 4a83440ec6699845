#pragma once
// The first line of what a file says of itself.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// The first comment ("# ...") of a TOML file that says something, without its sign, or the first sentence of
/// one at the beginning of an XML file; empty: it has none.
std::string first_comment(const std::filesystem::path& file);

}  // namespace puckloop::tools
