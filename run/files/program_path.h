#pragma once
// Where a scenario's files and its Linux programs are.

#include <filesystem>
#include <string>

namespace puckloop::tools {

/// Absolute, its folders as the system finds them: ".." after a linked folder is the parent of the folder
/// itself. Whether the file is there does not matter.
std::filesystem::path full_path(const std::filesystem::path& path);

/// The project's own image for `board` ("tam") that the build makes or the installation has; empty: there is
/// none.
std::filesystem::path own_image(const std::string& board);

/// A path with a slash counts from `folder`; a bare name is looked for among the project's own programs, then
/// in PATH. Returns the path unresolved when nothing is found, for the error that starting it will give.
std::filesystem::path find_program(const std::string& name, const std::filesystem::path& folder);

}  // namespace puckloop::tools
