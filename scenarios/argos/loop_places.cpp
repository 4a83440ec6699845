#include "scenarios/argos/loop_places.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::argos {

namespace {

constexpr double kThickness = 0.01, kHeight = 0.1;  // m, of a built wall
constexpr double kFreeOfWalls = 0.1;                // m; published loop functions have 0.1 or 0.65
constexpr long long kMostRobots = 1000;

/// A regular polygon about the origin, the first wall across the x axis; the distance from there to a wall,
/// m.
double add_walls(XmlFile& file, pugi::xml_node params, Tree& root) {
    constexpr long long kMost = 100;
    const long long sides = file.integer(params, "number_edges", 3, kMost, 3);
    const long long blocks = file.integer(params, "number_boxes_per_edge", 1, kMost, 1);
    // Published with both spellings.
    const char* spelt = params.attribute("length_boxes") ? "length_boxes" : "lenght_boxes";
    const double block = file.number(params, spelt, 0.25);
    if (!(block > 0.0)) file.fail(params, fmt::format("<params>: {} is not above 0", spelt), "a length in m");
    const double length = block * static_cast<double>(blocks);
    const double to_wall = length / (2.0 * std::tan(std::numbers::pi / static_cast<double>(sides)));
    const int line = file.line_of(params);
    for (long long side = 0; side < sides; ++side) {
        const double turn = 2.0 * std::numbers::pi * static_cast<double>(side) / static_cast<double>(sides);
        Tree wall(line);
        wall.text("name", fmt::format("built_wall_{}", side + 1))
            .lengths("centre", {to_wall * std::cos(turn), to_wall * std::sin(turn)})
            .quantity("heading", turn * 180.0 / std::numbers::pi, "deg")
            .lengths("size", {kThickness, length, kHeight});
        root.add("box", wall);
    }
    file.note(params, fmt::format("the loop functions build {} walls of {:.4g} m: here they are boxes, and "
                                  "the lamps of their blocks are not taken over",
                                  sides, length));
    return to_wall;
}

}  // namespace

LoopPlaces read_loop_places(XmlFile& file, Tree& root) {
    LoopPlaces places;
    places.params = file.root().child("loop_functions").child("params");
    const bool builds = file.flag(places.params, "build_arena", false);
    if (builds) places.radius = std::max(0.0, add_walls(file, places.params, root) - kFreeOfWalls);
    if (places.params.attribute("dist_radius")) places.radius = file.number(places.params, "dist_radius");
    if (!(places.radius >= 0.0))
        file.fail(places.params, "<params>: dist_radius is below 0", "a radius in m");
    if (places.radius > 0.0)
        places.robots = file.integer(places.params, "number_robots", 0, kMostRobots, builds ? 1 : 0);
    return places;
}

}  // namespace puckloop::argos
