#pragma once
// What puckloop-netmanager printed of itself (--status): settings, links and last messages.

#include <filesystem>
#include <string>

namespace puckloop::view {

/// JSON: a list of {"computer", "status"}: of each Linux program in the folder that printed a status, the
/// last one up to `time`, s since it began. Looked for in the last kMostStatusBytes of its log; what is
/// damaged is left out.
std::string network_status(const std::filesystem::path& folder, double time);

inline constexpr std::size_t kMostStatusBytes = 4U << 20;

}  // namespace puckloop::view
