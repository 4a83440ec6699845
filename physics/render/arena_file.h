#pragma once
// arena.json of a results folder: the world that was run, as whoever draws the run needs it.

#include "physics/description/description.h"

#include <filesystem>

namespace puckloop::physics {

/// Its "format": goes up when a reader of the one before would draw something else.
inline constexpr int kArenaFormat = 1;

/// {"format": 1, "world": {...}}, without where the run recorded. Throws RunError.
void write_arena_file(World world, const std::filesystem::path& file);

/// Throws InputError for a file that is not there, is damaged or of another format.
World read_arena_file(const std::filesystem::path& file);

}  // namespace puckloop::physics
