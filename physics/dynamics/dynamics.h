#pragma once
// Rigid bodies and contacts: robots, movable things and the floor in one ODE world (double precision,
// dWorldStep, 1 ms). Sources: ODE 0.16 manual; physics facts, section 8.
//
// Deviations: 1. a wheel touches the floor in one point, the lowest of a thin disc, so that it scrubs and
// creeps only as floor_motion.h states.
// 2. Contacts of robots and cylinders with anything upright are found in plan (they do not topple over each
// other); boxes meet boxes and the floor in space. 3. No gyroscopic torques. 4. Rolling resistance is nil.

#include "physics/description/plan.h"

#include <array>
#include <compare>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace puckloop::physics {

struct Parameters;
struct BodyParameters;
struct FloorVelocity;
class StepObserver;

inline constexpr double kStepSeconds = 1e-3;

/// A robot's place: middle of the axle in plan, and how the body stands. SI.
struct RobotState {
    double x = 0.0, y = 0.0, heading = 0.0;
    double pitch = 0.0;                ///< nose down is positive
    double roll = 0.0;                 ///< right side down is positive
    std::array<double, 3> velocity{};  ///< of the body's centre of mass
    std::array<double, 2> wheel{};     ///< turned angle left, right; counts through full turns
};

struct ObjectState {
    double x = 0.0, y = 0.0, heading = 0.0;
};

/// A robot's body against something upright.
struct RobotContact {
    enum class Kind : std::uint8_t { Fixed, Object, Robot };
    std::size_t robot = 0;
    Kind kind = Kind::Fixed;
    std::size_t other = 0;  ///< index among the fixed shapes, the objects, the robots (a lower one)

    friend auto operator<=>(const RobotContact&, const RobotContact&) = default;
};

class Dynamics {
  public:
    Dynamics(const Parameters& world, const std::vector<Shape>& fixed);
    ~Dynamics();
    Dynamics(const Dynamics&) = delete;
    Dynamics& operator=(const Dynamics&) = delete;

    /// Both return the index by which the body is asked for later.
    std::size_t add_robot(const BodyParameters& parameters, double x, double y, double heading);
    std::size_t add_object(const Shape& shape, double heading, double mass);

    /// Wheel speeds (rad/s relative to the body) that the motors ask for during the next step.
    void drive(std::size_t robot, double left, double right);
    /// How the floor moves under the robot from the next step on; without this it stands still.
    void move_floor(std::size_t robot, const FloorVelocity& velocity);
    // Hands that reach in between two steps (physics/events/dynamics_hands.cpp).
    std::size_t add_fixed(const Shape& shape);
    /// Of the same kind and size as before.
    void place_fixed(std::size_t index, const Shape& shape);
    void remove_fixed(std::size_t index);
    /// Standing on the floor, moving at (vx, vy) m/s.
    void place_object(std::size_t index, double x, double y, double heading, double vx, double vy);
    void remove_object(std::size_t index);
    /// Held fast in the air: nothing touches it, its wheels turn freely.
    void hold_robot(std::size_t index);
    void release_robot(std::size_t index);
    /// Upright and at rest; held or not as before.
    void place_robot(std::size_t index, double x, double y, double heading);

    /// One kStepSeconds. Throws RunError when a body has left the numbers.
    void step();
    /// Hears of every part of the steps to come; nullptr: nobody does.
    void observe(StepObserver* observer);

    const RobotState& robot(std::size_t index) const;
    const ObjectState& object(std::size_t index) const;
    /// Those of the last step.
    std::span<const RobotContact> robot_contacts() const;

    /// How often ODE warned, and its first warning.
    std::uint64_t ode_warnings() const;
    const std::string& first_ode_warning() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace puckloop::physics
