#pragma once
// Files that a run writes much later: whether they can be written is known at once.

#include <filesystem>

namespace puckloop::tools {

/// Throws InputError: a folder, or a place where no file can be made. Leaves what is there as it is.
void check_writable(const std::filesystem::path& path);

}  // namespace puckloop::tools
