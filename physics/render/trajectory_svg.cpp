#include "physics/render/trajectory_svg.h"

#include "base/error.h"
#include "base/files/new_file.h"
#include "physics/render/run_picture.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

namespace puckloop::physics {

void write_trajectory_svg(const World& world, const std::filesystem::path& directory) {
    const Paths robots = read_paths(directory / "trajectory.csv");
    const auto objects_file = directory / "objects.csv";
    const Paths objects = std::filesystem::exists(objects_file) ? read_paths(objects_file) : Paths{};
    const auto booths =
        world.booths.empty() ? std::vector<BoothColours>{} : read_booth_colours(directory / "tams.csv");
    const auto trails = world.virtuals.pheromones.empty() ? std::vector<TrailSquare>{}
                                                          : read_trails(world, directory / "pheromones.csv");
    const std::string document = Picture(world, robots, objects, booths, trails).draw();
    const auto file = directory / "trajectory.svg";
    std::FILE* out = new_file(file);
    const bool written = out != nullptr && std::fputs(document.c_str(), out) >= 0;
    const bool closed = out != nullptr && std::fclose(out) == 0;
    if (!written || !closed)
        throw RunError(fmt::format("{}: cannot write: {}", file.string(), why_not_written(errno)));
}

}  // namespace puckloop::physics
