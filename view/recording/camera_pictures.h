#pragma once
// What the cameras of robots' Linux boards saw: pictures that a run saved (`save_frames`).

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace puckloop::view {

/// JSON: a list of cameras with pictures: "robot", "kind" ("front" or "omni"), and by picture "t" (s) and
/// "frame" (its number). Read anew with each call. A damaged row is left out.
std::string camera_list(const std::filesystem::path& folder, const std::vector<std::string>& robots);

/// Picture `frame` of the camera with that number ("camera" of the list);
/// a PPM file's bytes. Nothing: there is none, or it has more than kMostPictureBytes.
std::optional<std::string> camera_picture(const std::filesystem::path& folder,
                                          const std::vector<std::string>& robots, std::size_t camera,
                                          std::size_t frame);

inline constexpr std::size_t kMostPictureBytes = 32U << 20;

}  // namespace puckloop::view
