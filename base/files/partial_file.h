#pragma once
// What a full disk leaves of a file.

#include <filesystem>

namespace puckloop {

/// Removes a file that could not be written whole; a device or pipe, and what is not there, stay as they are.
void remove_partial(const std::filesystem::path& file);

}  // namespace puckloop
