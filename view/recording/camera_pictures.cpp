#include "view/recording/camera_pictures.h"

#include "base/files/text_file.h"
#include "base/json.h"
#include "base/text/csv.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kCameraKinds{"front", "omni"};

std::string picture_name(std::size_t frame) {
    return fmt::format("{:08d}.ppm", frame);
}

/// Numbers of the pictures in a camera's folder.
std::set<std::string> pictures_in(const fs::path& folder) {
    std::set<std::string> names;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none))
        if (entry.path().extension() == ".ppm") names.insert(entry.path().filename().string());
    return names;
}

}  // namespace

std::string camera_list(const fs::path& folder, const std::vector<std::string>& robots) {
    ordered_json cameras = ordered_json::array();
    for (std::size_t robot = 0; robot < robots.size(); ++robot)
        for (std::size_t kind = 0; kind < kCameraKinds.size(); ++kind) {
            const std::string name = fmt::format("{}.{}", robots[robot], kCameraKinds[kind]);
            const std::set<std::string> there = pictures_in(folder / name);
            if (there.empty()) continue;
            ordered_json times = ordered_json::array(), frames = ordered_json::array();
            std::ifstream in(folder / (name + ".csv"));
            std::string line;
            std::getline(in, line);
            while (std::getline(in, line)) {
                const auto cells = csv_cells(line, ',');
                double time = 0.0, frame = 0.0;
                if (cells.size() < 3 || !csv_number(cells[0], time) || !csv_number(cells[1], frame)) continue;
                if (frame < 0 || frame > 99'999'999) continue;
                if (!there.contains(picture_name(static_cast<std::size_t>(frame)))) continue;
                times.push_back(time);
                frames.push_back(static_cast<std::size_t>(frame));
            }
            cameras.push_back({{"camera", robot * kCameraKinds.size() + kind},
                               {"robot", robots[robot]},
                               {"kind", kCameraKinds[kind]},
                               {"t", std::move(times)},
                               {"frame", std::move(frames)}});
        }
    return cameras.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

std::optional<std::string> camera_picture(const fs::path& folder, const std::vector<std::string>& robots,
                                          std::size_t camera, std::size_t frame) {
    const std::size_t robot = camera / kCameraKinds.size();
    if (robot >= robots.size()) return std::nullopt;
    const fs::path file = folder /
                          fmt::format("{}.{}", robots[robot], kCameraKinds[camera % kCameraKinds.size()]) /
                          picture_name(frame);
    std::error_code none;
    const auto bytes = fs::file_size(file, none);
    if (none || bytes > kMostPictureBytes || fs::is_symlink(file)) return std::nullopt;
    return read_whole_file(file);
}

}  // namespace puckloop::view
