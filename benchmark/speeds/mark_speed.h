#pragma once
// What it costs to take a board back to a mark (cosim::Rewindable).

#include <filesystem>

namespace puckloop::tools {

enum class MarkedBoard { Main, Rab };
enum class GoingBack { Mark, Rewind };

/// Marks set, or goings back, a microsecond, each after 0.2 ms of the board's running, measured for about
/// `wall_s` seconds. Throws InputError if the image cannot be read.
double mark_speed(const std::filesystem::path& image, MarkedBoard board, GoingBack what, double wall_s);

}  // namespace puckloop::tools
