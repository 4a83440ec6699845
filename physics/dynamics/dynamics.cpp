#include "physics/dynamics/dynamics.h"

#include "base/error.h"
#include "physics/dynamics/dynamics_bodies.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr int kAxisY = 2;  // ODE's number for it
constexpr double kWheelWidth = 0.005;
constexpr double kRestSpeed = 1e-4;  // m/s and rad/s below which a movable thing is asleep after kRestSteps
constexpr double kRestTurn = 1e-3;
constexpr int kRestSteps = 50;
constexpr double kFar = 1e4;  // m: no body gets there in earnest

/// ODE rotations are 3 rows of 4; column `c` of a body's rotation is its axis c in the world.
std::array<double, 3> axis_of(dBodyID body, int c) {
    const dReal* r = dBodyGetRotation(body);
    return {r[c], r[4 + c], r[8 + c]};
}

dBodyID make_body(dWorldID world, const dMass& mass, double x, double y, double z, double heading) {
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x, y, z);
    dMatrix3 rotation;
    dRFromAxisAndAngle(rotation, 0, 0, 1, heading);
    dBodySetRotation(body, rotation);
    dBodySetGyroscopicMode(body, 0);
    return body;
}

/// The change from `from` to `to`, both angles within +-pi, the short way.
double turn(double from, double to) {
    const double change = to - from;
    // Within half a turn the remainder is the change itself.
    return std::abs(change) < 3.0 ? change : std::remainder(change, 2 * std::numbers::pi);
}

}  // namespace

Dynamics::Impl::Impl(const Parameters& parameters, const std::vector<Shape>& fixed_shapes)
    : contact(parameters.contact) {
    const OdeSession session(ode_warnings);
    world = dWorldCreate();
    contacts = dJointGroupCreate(0);
    const auto& p = parameters.world;
    const double gx = std::sin(p.slope_x);
    const double gy = std::sin(p.slope_y);
    dWorldSetGravity(world, -p.gravity * gx, -p.gravity * gy, -p.gravity * std::sqrt(1 - gx * gx - gy * gy));
    dWorldSetERP(world, contact.erp);
    dWorldSetCFM(world, contact.cfm);
    dWorldSetContactMaxCorrectingVel(world, contact.max_velocity);
    dWorldSetContactSurfaceLayer(world, contact.surface_layer);
    floor = dCreatePlane(nullptr, 0, 0, 1, 0);
    for (const auto& shape : fixed_shapes)
        set_fixed(fixed.emplace_back(), shape);
}

void Dynamics::Impl::set_fixed(FixedBody& body, const Shape& shape) {
    body.shape = shape;
    if (shape.kind != Shape::Kind::Box) return;
    if (body.geom == nullptr)
        body.geom = dCreateBox(nullptr, 2 * shape.half_length, 2 * shape.half_width, shape.height);
    dGeomSetPosition(body.geom, shape.x, shape.y, shape.height / 2);
    dMatrix3 rotation;
    dRFromAxisAndAngle(rotation, 0, 0, 1, std::atan2(shape.sine, shape.cosine));
    dGeomSetRotation(body.geom, rotation);
}

Dynamics::Impl::~Impl() {
    const OdeSession session(ode_warnings);
    for (const auto& body : fixed)
        if (body.geom != nullptr) dGeomDestroy(body.geom);
    for (const auto& object : objects)
        dGeomDestroy(object.geom);
    dGeomDestroy(floor);
    dJointGroupDestroy(contacts);
    dWorldDestroy(world);
}

void Dynamics::Impl::read_robot(RobotBody& robot) const {
    const auto forward = axis_of(robot.chassis, 0);
    const auto left = axis_of(robot.chassis, 1);
    const dReal* a = dBodyGetPosition(robot.wheel[0]);
    const dReal* b = dBodyGetPosition(robot.wheel[1]);
    const dReal* v = dBodyGetLinearVel(robot.chassis);
    auto& s = robot.state;
    s.x = (a[0] + b[0]) / 2;
    s.y = (a[1] + b[1]) / 2;
    s.heading += turn(s.heading, std::atan2(forward[1], forward[0]));
    s.pitch = -std::asin(std::clamp(forward[2], -1.0, 1.0));
    s.roll = std::asin(std::clamp(left[2], -1.0, 1.0));
    s.velocity = {v[0], v[1], v[2]};
    for (std::size_t side = 0; side < 2; ++side) {
        const double angle = dJointGetHingeAngle(robot.motor[side]);
        s.wheel[side] += turn(robot.last_angle[side], angle);
        robot.last_angle[side] = angle;
    }
    robot.shape.place(s.x, s.y, s.heading);
    if (!(std::abs(s.x) < kFar) || !(std::abs(s.y) < kFar) || !std::isfinite(s.heading + s.pitch))
        throw RunError(fmt::format("physics: a robot left the world, at ({}, {}) m", s.x, s.y));
}

void Dynamics::Impl::read_object(ObjectBody& object) {
    const dReal* p = dBodyGetPosition(object.body);
    const auto along = axis_of(object.body, 0);
    auto& s = object.state;
    s.x = p[0];
    s.y = p[1];
    s.heading += turn(s.heading, std::atan2(along[1], along[0]));
    object.shape.place(s.x, s.y, s.heading);
    if (!(std::abs(s.x) < kFar) || !(std::abs(s.y) < kFar))
        throw RunError(fmt::format("physics: an object left the world, at ({}, {}) m", s.x, s.y));
}

void Dynamics::Impl::damp_pitch(const RobotBody& robot) const {
    const auto left = axis_of(robot.chassis, 1);
    const dReal* w = dBodyGetAngularVel(robot.chassis);
    const double rate = left[0] * w[0] + left[1] * w[1] + left[2] * w[2];
    dBodyAddRelTorque(robot.chassis, 0, -robot.parameters.pitch_damping * rate, 0);
}

/// What moves all of the floor under a robot moves its bodies as much, so that nothing slides or rocks; not
/// against something upright.
void Dynamics::Impl::take_along(std::size_t index) {
    auto& robot = robots[index];
    const FloorVelocity now = robot.floor.value_or(FloorVelocity{});
    const double x = now.x - robot.floor_before.x, y = now.y - robot.floor_before.y,
                 turn = now.turn - robot.floor_before.turn;
    robot.floor_before = now;
    if (robot.hand != nullptr || (x == 0.0 && y == 0.0 && turn == 0.0)) return;
    const auto held = [&](const RobotContact& c) {
        return c.robot == index || (c.kind == RobotContact::Kind::Robot && c.other == index);
    };
    if (std::any_of(robot_contacts.begin(), robot_contacts.end(), held)) return;
    for (const dBodyID body : {robot.chassis, robot.wheel[0], robot.wheel[1]}) {
        const dReal *at = dBodyGetPosition(body), *v = dBodyGetLinearVel(body), *w = dBodyGetAngularVel(body);
        dBodySetLinearVel(body, v[0] + x - turn * (at[1] - robot.state.y),
                          v[1] + y + turn * (at[0] - robot.state.x), v[2]);
        dBodySetAngularVel(body, w[0], w[1], w[2] + turn);
    }
}

Dynamics::Dynamics(const Parameters& world, const std::vector<Shape>& fixed)
    : impl_(std::make_unique<Impl>(world, fixed)) {}

Dynamics::~Dynamics() = default;

std::size_t Dynamics::add_robot(const BodyParameters& p, double x, double y, double heading) {
    const OdeSession session(impl_->ode_warnings);
    const double cosine = std::cos(heading);
    const double sine = std::sin(heading);
    RobotBody robot;
    robot.parameters = p;
    robot.shape = circle_shape(x, y, p.radius, p.height, p.reflectivity);
    dMass mass;
    const double disc = p.load * p.radius * p.radius / 4;  // inertia of the load about a diameter
    dMassSetParameters(&mass, p.mass - 2 * p.wheel_mass + p.load, 0, 0, 0, p.inertia_x + disc,
                       p.inertia_y + disc, p.inertia_z + 2 * disc, 0, 0, 0);
    robot.chassis = make_body(impl_->world, mass, x + cosine * p.com_x, y + sine * p.com_x, p.com_z, heading);
    robot.wheel_radius = {p.wheel_radius_left, p.wheel_radius_right};
    for (std::size_t side = 0; side < 2; ++side) {
        const double radius = robot.wheel_radius[side];
        const double out = (side == 0 ? 0.5 : -0.5) * p.axle_length;
        const double wx = x - sine * out;
        const double wy = y + cosine * out;
        dMassSetCylinderTotal(&mass, p.wheel_mass, kAxisY, radius, kWheelWidth);
        robot.wheel[side] = make_body(impl_->world, mass, wx, wy, radius, heading);
        const dJointID motor = dJointCreateHinge(impl_->world, nullptr);
        dJointAttach(motor, robot.wheel[side], robot.chassis);
        dJointSetHingeAnchor(motor, wx, wy, radius);
        dJointSetHingeAxis(motor, -sine, cosine, 0);
        dJointSetHingeParam(motor, dParamFMax, p.stall_torque);
        dJointSetHingeParam(motor, dParamVel, 0);
        robot.motor[side] = motor;
    }
    robot.state.heading = heading;
    impl_->read_robot(robot);
    impl_->robots.push_back(robot);
    impl_->near.forget();
    return impl_->robots.size() - 1;
}

std::size_t Dynamics::add_object(const Shape& shape, double heading, double kilograms) {
    const OdeSession session(impl_->ode_warnings);
    ObjectBody object;
    object.shape = shape;
    object.standing_height = shape.height / 2;
    dMass mass;
    if (shape.kind == Shape::Kind::Box) {
        dMassSetBoxTotal(&mass, kilograms, 2 * shape.half_length, 2 * shape.half_width, shape.height);
        object.geom = dCreateBox(nullptr, 2 * shape.half_length, 2 * shape.half_width, shape.height);
    } else {
        constexpr int kAxisZ = 3;
        dMassSetCylinderTotal(&mass, kilograms, kAxisZ, shape.radius, shape.height);
        object.geom = dCreateCylinder(nullptr, shape.radius, shape.height);
    }
    object.body = make_body(impl_->world, mass, shape.x, shape.y, object.standing_height, heading);
    dBodySetAutoDisableFlag(object.body, 1);
    dBodySetAutoDisableLinearThreshold(object.body, kRestSpeed);
    dBodySetAutoDisableAngularThreshold(object.body, kRestTurn);
    dBodySetAutoDisableSteps(object.body, kRestSteps);
    dGeomSetBody(object.geom, object.body);
    object.state.heading = heading;
    Impl::read_object(object);
    impl_->objects.push_back(object);
    impl_->near.forget();
    return impl_->objects.size() - 1;
}

void Dynamics::drive(std::size_t robot, double left, double right) {
    const auto& motor = impl_->robots[robot].motor;
    dJointSetHingeParam(motor[0], dParamVel, left);
    dJointSetHingeParam(motor[1], dParamVel, right);
}

void Dynamics::move_floor(std::size_t robot, const FloorVelocity& velocity) {
    impl_->robots[robot].floor = velocity;
}

void Dynamics::step() {
    const OdeSession session(impl_->ode_warnings);
    for (const auto& robot : impl_->robots)
        impl_->damp_pitch(robot);
    for (std::size_t i = 0; i < impl_->robots.size(); ++i)
        impl_->take_along(i);
    impl_->find_contacts();
    impl_->done(StepPart::Contacts);
    dWorldStep(impl_->world, kStepSeconds);
    impl_->done(StepPart::Solve);
    dJointGroupEmpty(impl_->contacts);
    for (auto& robot : impl_->robots)
        impl_->read_robot(robot);
    for (auto& object : impl_->objects)
        Impl::read_object(object);
}

void Dynamics::observe(StepObserver* observer) {
    impl_->observer = observer;
}

const RobotState& Dynamics::robot(std::size_t index) const {
    return impl_->robots[index].state;
}

const ObjectState& Dynamics::object(std::size_t index) const {
    return impl_->objects[index].state;
}

std::span<const RobotContact> Dynamics::robot_contacts() const {
    return impl_->robot_contacts;
}

std::uint64_t Dynamics::ode_warnings() const {
    return impl_->ode_warnings.count;
}

const std::string& Dynamics::first_ode_warning() const {
    return impl_->ode_warnings.first;
}

}  // namespace puckloop::physics
