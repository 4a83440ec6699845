#pragma once
// Which things can be near which robot. The lists are made once and hold until something has moved further
// than a slack, so that what a step looks at grows with the things near a robot and not with all there are.
//
// A list holds at least what is within reach, in rising order; whoever goes through it looks exactly.

#include "physics/description/plan.h"

#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::physics {

/// Something that moves, as a circle in plan; metres.
struct Disc {
    double x = 0.0, y = 0.0, radius = 0.0;
};

class Neighbours {
  public:
    /// The lists hold until a thing is `slack` metres from where it was when they were made.
    explicit Neighbours(double slack) : slack_(slack) {}

    /// Something was added, taken away, or is of another size; or a thing that does not move was moved.
    void forget() { made_ = false; }
    /// Do the lists hold for `count` moving things at the places (.x, .y) that `at(index)` gives?
    template <typename At>
    bool hold(std::size_t count, At at) const {
        if (!made_ || places_.size() != count) return false;
        for (std::size_t i = 0; i < count; ++i) {
            const auto& now = at(i);
            const double dx = now.x - places_[i].x, dy = now.y - places_[i].y;
            if (!(dx * dx + dy * dy <= slack_ * slack_)) return false;
        }
        return true;
    }
    /// `moving` has the robots first; `reach[i]` is how far from its middle robot i is interested in other
    /// things' edges.
    void make(std::vector<Disc> moving, std::span<const double> reach, std::span<const Shape* const> fixed);

    /// Indexes in `fixed`, and in `moving` without the robot itself.
    std::span<const std::uint32_t> fixed(std::size_t robot) const { return lists_[robot].fixed; }
    std::span<const std::uint32_t> moving(std::size_t robot) const { return lists_[robot].moving; }

  private:
    struct Lists {
        std::vector<std::uint32_t> fixed, moving;
    };
    double slack_;
    bool made_ = false;
    std::vector<Disc> places_;
    std::vector<Lists> lists_;  // by robot
};

}  // namespace puckloop::physics
