#pragma once
// The conditions of a plan, looked at once a step.

#include "physics/events/scene.h"

namespace puckloop::physics {

class Watches {
  public:
    /// All three must outlive it.
    Watches(const EventPlan& plan, const Scene& scene);

    /// An output of robot's board changed.
    void board_signal(std::size_t robot, std::uint16_t id, double value);
    /// After the bodies moved and before anything is done to them: ways add up.
    void bodies_moved();
    /// After what was done to them: numbers of the events whose condition has come true with this step.
    std::vector<std::size_t> come_true();

  private:
    struct Watch {
        std::size_t event;
        std::size_t robot;
        std::uint16_t signal = 0;  // of a LED
        bool lit = false;
        std::uint64_t fired = 0;  // how often it has come true
        bool was = false;
    };
    struct Way {
        double x = 0.0, y = 0.0, length = 0.0;
    };
    bool holds(const Watch& watch) const;

    const EventPlan& plan_;
    const Scene& scene_;
    std::vector<Watch> watches_;
    std::vector<Way> ways_;  // of the robots
};

}  // namespace puckloop::physics
