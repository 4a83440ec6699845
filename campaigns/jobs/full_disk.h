#pragma once
// Runs that a full disk ended: they are no result.

#include <filesystem>
#include <string>

namespace puckloop::jobs {

/// Whether a node or run reports that it could not write.
bool names_full_disk(const std::string& text);

/// RunError if `folder`'s disk has no room: a program may have met that without a word of ours.
void check_room(const std::filesystem::path& folder);

}  // namespace puckloop::jobs
