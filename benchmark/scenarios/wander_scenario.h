#pragma once
// Robots that wander, each with the same room around it: what `puckloop bench` times to see how cost grows.

#include <filesystem>

namespace puckloop::tools {

/// Writes a scenario of `robots` robots on a square grid, 30 cm apart, into `folder` and returns its path.
/// Their programs start one after the other, 7 ms apart, from 1 s on. `main_image` is the boards' firmware.
/// Throws RunError.
std::filesystem::path write_wander_scenario(const std::filesystem::path& folder, int robots,
                                            const std::filesystem::path& main_image);

}  // namespace puckloop::tools
