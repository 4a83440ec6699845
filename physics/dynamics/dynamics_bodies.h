#pragma once
// The ODE objects behind Dynamics: bodies and contacts. Only the dynamics' own files include this.

#include "physics/description/parameters.h"
#include "physics/dynamics/dynamics.h"
#include "physics/dynamics/floor_motion.h"
#include "physics/dynamics/neighbours.h"
#include "physics/dynamics/ode_library.h"
#include "physics/dynamics/step_observer.h"

#include <ode/ode.h>

#include <optional>

namespace puckloop::physics {

struct RobotBody {
    BodyParameters parameters{};
    dBodyID chassis = nullptr;
    std::array<dBodyID, 2> wheel{};
    std::array<double, 2> wheel_radius{};
    std::array<dJointID, 2> motor{};
    std::array<double, 2> last_angle{};
    std::optional<FloorVelocity> floor;  // if it moves
    FloorVelocity floor_before;          // in the step before
    dJointID hand = nullptr;             // holds it in the air
    Shape shape;
    RobotState state;
};

struct ObjectBody {
    dBodyID body = nullptr;
    dGeomID geom = nullptr;
    double standing_height = 0.0;  // of the centre of mass
    bool present = true;
    Shape shape;
    ObjectState state;
};

struct FixedBody {
    Shape shape;
    dGeomID geom = nullptr;  // boxes only: what movable boxes meet
    bool present = true;
};

struct Dynamics::Impl {
    Impl(const Parameters& world, const std::vector<Shape>& fixed_shapes);
    ~Impl();

    void read_robot(RobotBody& robot) const;
    static void read_object(ObjectBody& object);
    void set_fixed(FixedBody& body, const Shape& shape);
    void damp_pitch(const RobotBody& robot) const;
    void take_along(std::size_t index);

    // Contacts (dynamics_contacts.cpp).
    void find_contacts();
    void wheels_on_floor(const RobotBody& robot);
    void skids_on_floor(const RobotBody& robot);
    void object_on_floor(const ObjectBody& object);
    void robot_meets_others(std::size_t index);
    void refresh_neighbours();
    bool in_plan(dBodyID body, const Shape& circle, dBodyID other_body, const Shape& other, double mu);
    void boxes_meet(const ObjectBody& object, dBodyID other_body, dGeomID other);
    void add_contact(const dSurfaceParameters& surface, const dContactGeom& geom, dBodyID first,
                     dBodyID second, const dReal* direction = nullptr);
    dSurfaceParameters surface(double mu) const;

    void done(StepPart part) const {
        if (observer != nullptr) observer->done(part);
    }

    StepObserver* observer = nullptr;
    OdeWarnings ode_warnings;
    ContactParameters contact{};
    dWorldID world = nullptr;
    dJointGroupID contacts = nullptr;
    dGeomID floor = nullptr;
    std::vector<RobotBody> robots;
    std::vector<ObjectBody> objects;
    std::vector<FixedBody> fixed;
    std::vector<RobotContact> robot_contacts;  // of the last step
    Neighbours near{0.02};                     // of robots: what they may touch
};

}  // namespace puckloop::physics
