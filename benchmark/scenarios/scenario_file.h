#pragma once
// Scenarios that `puckloop bench` makes up, as files.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// Writes `text` as NAME.toml into `folder`, which is made, and returns its path. Throws RunError.
std::filesystem::path write_scenario(const std::filesystem::path& folder, const std::string& name,
                                     const std::string& text);

}  // namespace puckloop::tools
