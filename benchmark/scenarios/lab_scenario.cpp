#include "benchmark/scenarios/lab_scenario.h"

#include "base/json.h"
#include "benchmark/scenarios/scenario_file.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr double kToWalls = 1.231;  // m, from the centre to the middle of a side, for twenty robots
constexpr int kRobots = 20;
constexpr int kSides = 12;

std::string corners(double to_walls) {
    const double to_corner = to_walls / std::cos(std::numbers::pi / kSides);
    std::string text;
    for (int i = 0; i < kSides; ++i) {
        const double angle = (2 * i + 1) * std::numbers::pi / kSides;
        text += fmt::format("    [\"{:.4f} m\", \"{:.4f} m\"],\n", to_corner * std::cos(angle),
                            to_corner * std::sin(angle));
    }
    return text;
}

std::vector<std::string> program_of(const LabSpec& spec) {
    if (!spec.program.empty()) return spec.program;
    return {"puckloop-control", "--behaviour", "wander",        "--rab", "--rab-id",      "{n}",
            "--rab-bytes",      "4",           "--rab-emit-ms", "20",    "--rab-poll-ms", "5"};
}

}  // namespace

std::filesystem::path write_lab_scenario(const std::filesystem::path& folder, const LabSpec& spec) {
    constexpr double kFree = 0.13;   // m, from robots' centres to the walls at least
    constexpr double kWithin = 0.1;  // s, in which the programs start
    const double to_walls = kToWalls * std::sqrt(static_cast<double>(spec.robots) / kRobots);
    const std::string text = fmt::format(
        "[run]\nseed = 1\n[arena]\nfloor_grey = 0.5\ncorners = [\n{}]\n"
        "[[group]]\nname = \"epuck{{n}}\"\ncount = {}\nfirst = 1\n"
        "[group.place]\nkind = \"disc\"\nradius = \"{:.4f} m\"\ngap = \"1 cm\"\n"
        "[group.pic]\nfirmware = \"{}\"\n[group.rab]\nfirmware = \"{}\"\n"
        "[group.linux]\nprogram = {}\nstart = \"uniform({:.3f} s, {:.3f} s)\"\n",
        corners(to_walls), spec.robots, to_walls - kFree, std::filesystem::absolute(spec.main_image).string(),
        std::filesystem::absolute(spec.rab_image).string(), nlohmann::json(program_of(spec)).dump(),
        spec.start_s, spec.start_s + kWithin);
    return write_scenario(folder, fmt::format("lab{}", spec.robots), text);
}

}  // namespace puckloop::tools
