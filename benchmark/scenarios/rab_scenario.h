#pragma once
// Robots with range-and-bearing boards that send and poll all the time: what `puckloop bench` times.

#include <filesystem>

namespace puckloop::tools {

/// Writes a scenario of `robots` robots on a circle into `folder` and returns its path. `main_image` and
/// `rab_image` are the boards' firmware.
std::filesystem::path write_rab_scenario(const std::filesystem::path& folder, int robots,
                                         const std::filesystem::path& main_image,
                                         const std::filesystem::path& rab_image);

}  // namespace puckloop::tools
