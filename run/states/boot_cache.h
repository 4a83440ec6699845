#pragma once
// Where boards' boots are kept from one run to the next: $PUCKLOOP_CACHE, $XDG_CACHE_HOME/puckloop or
// ~/.cache/puckloop, for its owner alone. One state file per boot, written whole or not at all, so that runs
// at the same time do not disturb each other; when they take too much room the ones not used for longest go.

#include "cosim/core/time.h"
#include "cosim/resume/board_state.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace puckloop::tools {

inline constexpr std::uintmax_t kCacheBytes = std::uintmax_t{256} << 20;

struct CacheFolder {
    std::filesystem::path path;  ///< empty: no home is known
    bool asked_for = false;      ///< PUCKLOOP_CACHE names it: the user counts on it
    friend bool operator==(const CacheFolder&, const CacheFolder&) = default;
};

/// The folder that the environment names; none if PUCKLOOP_CACHE is "off" or empty.
std::optional<CacheFolder> cache_folder();

/// Makes it if absent. Returns why it cannot be used, or nothing.
std::string prepare_cache(const std::filesystem::path& folder);

/// The file for a board's boot of `length` in a world described by `world`, written by this build.
std::filesystem::path cached_boot(const std::filesystem::path& folder, const cosim::BoardIdentity& board,
                                  cosim::Time length, const std::string& world);

/// Removes the files used longest ago until the rest take at most `most` bytes.
void prune_cache(const std::filesystem::path& folder, std::uintmax_t most = kCacheBytes);

}  // namespace puckloop::tools
