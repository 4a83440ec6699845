#pragma once
// A mission as a table: what is counted, and where. docs/swarm.md gives the objective functions and their
// sources.

#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

namespace puckloop::missions {

/// Where a robot is: the middle of its axle, m.
struct Place {
    double x = 0.0, y = 0.0;
};

/// A disc or an upright rectangle on the floor, edges included.
struct Region {
    bool disc = false;
    double x = 0.0, y = 0.0;           ///< of the middle, m
    double radius = 0.0;               ///< of a disc, m
    double length = 0.0, width = 0.0;  ///< of a rectangle, along x and y, m

    /// From its edge, m; 0 in it.
    double distance(const Place& place) const {
        const auto beyond = [](double way, double half) { return way <= half ? 0.0 : way - half; };
        if (disc) return beyond(std::hypot(place.x - x, place.y - y), radius);
        return std::hypot(beyond(std::abs(place.x - x), length / 2),
                          beyond(std::abs(place.y - y), width / 2));
    }
    bool holds(const Place& place) const { return distance(place) == 0.0; }
};

enum class Kind {
    Aggregation,     ///< sum over the steps of the robots in a spot, or their share at the end
    Foraging,        ///< items brought from a spot to the nest
    Coverage,        ///< at the end: mean distance from a point of the area to the nearest robot, m
    GridExploration  ///< minus the mean age of the cells, summed over the steps
};

/// Whether a swarm does better with more of the score.
constexpr bool more_is_better(Kind kind) {
    return kind != Kind::Coverage;
}

struct Mission {
    std::string name;  ///< of its kind, as the scenario has it
    Kind kind = Kind::Aggregation;
    double begin = 0.0;         ///< s: the first step ends one step later
    double step = 0.1;          ///< s
    std::vector<Region> spots;  ///< counted, or sources of items; coverage: where robots do not count
    Region nest{};              ///< foraging
    Region area{};              ///< coverage, grid exploration
    bool at_end = false;        ///< aggregation: share at the end
    std::size_t cells = 10;     ///< grid exploration: rows and columns
};

}  // namespace puckloop::missions
