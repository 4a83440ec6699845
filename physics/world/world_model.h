#pragma once
// The physical world in steps of 1 ms: wheels in, sensor channels out.

#include "physics/description/booth.h"
#include "physics/dynamics/neighbours.h"
#include "physics/dynamics/step_observer.h"
#include "physics/robot/robot_model.h"

#include <cstdint>
#include <deque>
#include <set>
#include <span>
#include <vector>

namespace puckloop::physics {

class WorldModel {
  public:
    /// Throws InputError if check(description) does.
    explicit WorldModel(World description);

    /// A motor counter changed at `seconds`, which lies in the step to come.
    void wheel(std::size_t robot, Side side, double steps, double seconds);
    /// An output of a robot's board changed: LEDs by which it lays a trail.
    void board_signal(std::size_t robot, std::uint16_t id, double value);
    /// One millisecond on; channels are those of the new state. The same as the two that follow.
    void step();
    void move_bodies();
    void sense();
    /// Hears of every part of the steps to come; nullptr: nobody does.
    void observe(StepObserver* observer);
    /// A part of the step has been done, here or by whoever steps this.
    void done(StepPart part) const {
        if (observer_ != nullptr) observer_->done(part);
    }

    std::uint64_t steps_done() const { return steps_done_; }
    double seconds() const { return static_cast<double>(steps_done_) * kStepSeconds; }
    /// Floor, lamps, loudspeakers and light as they are now; robots and bodies as they were at the start.
    const World& description() const { return description_; }
    const Parameters& parameters() const { return parameters_; }
    std::size_t robot_count() const { return robots_.size(); }
    const RobotModel& robot(std::size_t index) const { return robots_[index]; }
    std::size_t booth_count() const { return booths_.size(); }
    const BoothModel& booth(std::size_t index) const { return booths_[index]; }
    /// To let its lights shine.
    BoothModel& booth(std::size_t index) { return booths_[index]; }
    const RobotState& state(std::size_t robot) const { return dynamics_.robot(robot); }
    /// Names and places of the movable things, those that have been taken away as well.
    std::span<const std::string> object_names() const { return object_names_; }
    const ObjectState& object(std::size_t index) const { return dynamics_.object(index); }
    const Dynamics& dynamics() const { return dynamics_; }
    /// Trails on the floor, in the order of the description.
    std::span<const PheromoneField> trails() const { return trails_; }
    /// What only robots' sensors meet, as it is now.
    std::span<const VirtualBody> virtual_bodies() const { return virtual_bodies_; }
    /// Things that do not move by themselves, the arena's walls first: names, and as sensors see them (height
    /// 0: taken away).
    std::span<const std::string> fixed_names() const { return fixed_names_; }
    std::size_t fixed_count() const { return fixed_.size(); }
    const Shape& fixed(std::size_t index) const { return fixed_[index]; }
    /// Those that have been moved or added since the start.
    const std::set<std::size_t>& fixed_by_hand() const { return fixed_by_hand_; }
    /// A movable thing, or a robot, as sensors see it.
    const Shape& object_shape(std::size_t index) const { return moving_[robots_.size() + index].shape; }
    const Shape& robot_shape(std::size_t index) const { return moving_[index].shape; }

  private:
    friend class Scene;  // physics/events/scene.h: changes it between steps

    /// A moving body as sensors see it, and where it was when they last looked.
    struct Moving {
        Shape shape;
        double x = 0.0, y = 0.0, heading = 0.0;
        bool moved = true;
        void update(double new_x, double new_y, double new_heading);
    };

    void add_bodies();
    void add_object(const Shape& shape, const std::string& name, double heading, double mass);
    void look();
    void refresh_neighbours();
    void look_around(std::size_t robot);
    void look_at_lamps(std::size_t robot, bool any_moved);
    void renew_trails();
    void look_down(std::size_t robot);
    void look_at_barriers();
    bool neighbour_moved(std::size_t robot) const;

    World description_;
    Parameters parameters_;
    std::vector<Shape> fixed_;
    std::vector<std::string> fixed_names_;
    std::set<std::size_t> fixed_by_hand_;
    Dynamics dynamics_;
    std::vector<std::string> object_names_;
    std::deque<RobotModel> robots_;
    std::vector<Moving> moving_;  // robots first, then objects
    Neighbours near_{0.03};       // of robots: what their proximity sensors may see
    std::vector<std::array<double, 2>> looked_tilt_;
    std::vector<BoothModel> booths_;
    std::vector<std::vector<std::size_t>> in_booths_;  // fixed things that might interrupt a beam
    std::vector<VirtualBody> virtual_bodies_;
    std::vector<PheromoneField> trails_;
    std::vector<const Shape*> view_;  // scratch
    std::uint64_t steps_done_ = 0;
    StepObserver* observer_ = nullptr;
    bool scene_changed_ = true;    // since the sensors last looked
    bool trails_changed_ = false;  // likewise
};

}  // namespace puckloop::physics
