#include "run/states/boot_cache.h"

#include "base/sha256.h"
#include "cosim/resume/state_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

namespace puckloop::tools {

namespace {
constexpr std::string_view kEnding = ".state";
}

std::optional<CacheFolder> cache_folder() {
    if (const char* named = std::getenv("PUCKLOOP_CACHE")) {
        const std::string folder = named;
        if (folder.empty() || folder == "off") return std::nullopt;
        return CacheFolder{std::filesystem::absolute(folder), true};
    }
    // The XDG rules: a relative path counts as not set.
    if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && cache[0] == '/')
        return CacheFolder{std::filesystem::path(cache) / "puckloop"};
    if (const char* home = std::getenv("HOME"); home && home[0] == '/')
        return CacheFolder{std::filesystem::path(home) / ".cache" / "puckloop"};
    return CacheFolder{};
}

std::string prepare_cache(const std::filesystem::path& folder) {
    if (folder.empty()) return "neither XDG_CACHE_HOME nor HOME is an absolute path";
    std::error_code error;
    std::filesystem::create_directories(folder.parent_path(), error);
    if (::mkdir(folder.c_str(), 0700) != 0 && errno != EEXIST) return std::strerror(errno);
    struct stat info {};
    if (::stat(folder.c_str(), &info) != 0) return std::strerror(errno);
    if (!S_ISDIR(info.st_mode)) return "is no folder";
    if (info.st_uid != ::geteuid()) return "belongs to somebody else";
    if ((info.st_mode & (S_IWGRP | S_IWOTH)) != 0) return "others may write there";
    if (::access(folder.c_str(), R_OK | W_OK | X_OK) != 0) return std::strerror(errno);
    return {};
}

std::filesystem::path cached_boot(const std::filesystem::path& folder, const cosim::BoardIdentity& board,
                                  cosim::Time length, const std::string& world) {
    std::string text;
    for (const std::string& part :
         {cosim::build_id(), fmt::format("{}", cosim::kStateFormat), board.node, board.kind, board.chip,
          board.image, board.parameters, fmt::format("{}", length), world})
        text += fmt::format("{}:{}\n", part.size(), part);
    return folder / (sha256_text(text) + std::string(kEnding));
}

void prune_cache(const std::filesystem::path& folder, std::uintmax_t most) {
    struct Entry {
        std::filesystem::file_time_type used;
        std::uintmax_t size = 0;
        std::filesystem::path path;
    };
    std::vector<Entry> entries;
    std::uintmax_t total = 0;
    std::error_code error;
    // Other runs may remove files meanwhile: what is gone is no error.
    for (auto it = std::filesystem::directory_iterator(folder, error);
         !error && it != std::filesystem::directory_iterator(); it.increment(error)) {
        if (it->path().filename().string().find(kEnding) == std::string::npos) continue;
        std::error_code gone;
        Entry entry{it->last_write_time(gone), 0, it->path()};
        if (!gone) entry.size = it->file_size(gone);
        if (gone) continue;
        total += entry.size;
        entries.push_back(std::move(entry));
    }
    std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) { return a.used < b.used; });
    for (const Entry& entry : entries) {
        if (total <= most) return;
        if (std::filesystem::remove(entry.path, error)) total -= entry.size;
    }
}

}  // namespace puckloop::tools
