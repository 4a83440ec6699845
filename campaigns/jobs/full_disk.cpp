#include "campaigns/jobs/full_disk.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

namespace puckloop::jobs {

bool names_full_disk(const std::string& text) {
    constexpr std::array kErrors{ENOSPC, EDQUOT};
    return std::any_of(kErrors.begin(), kErrors.end(),
                       [&](int error) { return text.find(std::strerror(error)) != std::string::npos; });
}

void check_room(const std::filesystem::path& folder) {
    constexpr std::uintmax_t kLeast = 64 * 1024;  // bytes
    std::error_code error;
    const auto space = std::filesystem::space(folder, error);
    if (error || space.available >= kLeast) return;
    throw RunError(
        fmt::format("{}: the disk is full ({} KiB are left)", folder.string(), space.available / 1024));
}

}  // namespace puckloop::jobs
