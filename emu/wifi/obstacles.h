#pragma once
// What stands between stations: walls and things, seen from above. Each that the line between two stations
// crosses takes its loss of what passes (COST 231 final report, 4.7.2: multi-wall model).
//
// Deviations: 1. Two dimensions: whatever there is reaches as high as the line. 2. One loss for each body,
// however long the way through it is. 3. Nothing is reflected or goes round a corner.

#include "base/fields/field.h"

#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <vector>

namespace puckloop::wifi {

using Position = std::array<double, 2>;  ///< metres

struct Obstacle {
    std::string name;
    bool box = true;
    double x = 0, y = 0;           ///< m
    double heading = 0;            ///< rad
    double length = 0, width = 0;  ///< m, of a box; of a cylinder `length` is the diameter
    bool out = false;              ///< it is not there
    double loss = 0;               ///< dB
    int pose = -1;
    int away = -1;
    int shape = -1;

    template <class Visitor>
    static constexpr auto fields(Visitor&& visit) {
        using O = Obstacle;
        return visit(
            field("name", &O::name, "of the thing"), field("box", &O::box, "else it is a cylinder"),
            field("x", &O::x, "of its middle").in("m"), field("y", &O::y, "of its middle").in("m"),
            field("heading", &O::heading, "of its length").in("rad"),
            field("length", &O::length, "of a box; diameter of a cylinder").in("m"),
            field("width", &O::width, "of a box").in("m"),
            field("out", &O::out, "it is not in the world, at first"),
            field("loss", &O::loss, "of what passes through it").in("dB"),
            field("pose", &O::pose, "signal of the world at which its pose begins; -1: it does not move"),
            field("away", &O::away, "signal that is 1 while it is taken away; -1: none"),
            field("shape", &O::shape, "signal at which its shape begins; -1: none"));
    }
};
static_assert(lists_all_fields<Obstacle>);

/// Signals of a shape: 1 for a box, x, y, heading, half length or radius, half width, height (0: taken away),
/// one more (physics/world/pose_signals.h, which asks that this fits).
inline constexpr std::size_t kObstacleSignals = 8;

class Obstacles {
  public:
    /// `first_shape`: signal at which shapes begin, -1: there are none; `loss`: dB, of what is added later.
    Obstacles(std::vector<Obstacle> list, int first_shape, double loss);

    /// A signal of the world. False: it is of none of these.
    bool take(int signal, double value);
    /// dB, of all that the line from `a` to `b` crosses.
    double loss_between(const Position& a, const Position& b) const;
    bool empty() const { return list_.empty(); }

  private:
    struct Meaning {
        std::size_t obstacle = 0;
        int value = 0;  ///< 0 to 2: x, y, heading; 3: away; kShape and more: of the shape
    };
    void know(std::size_t obstacle);

    std::vector<Obstacle> list_;
    int first_shape_;
    double loss_;
    std::map<int, Meaning> signals_;
};

}  // namespace puckloop::wifi
