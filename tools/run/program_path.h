#pragma once
// Where a scenario's Linux program is.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// A path with a slash counts from `folder`; a bare name is looked for beside the running puckloop, then in
/// PATH. Returns the path unresolved when nothing is found, for the error that starting it will give.
std::filesystem::path find_program(const std::string& name, const std::filesystem::path& folder);

}  // namespace puckloop::tools
