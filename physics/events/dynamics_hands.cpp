// Hands that reach into the world between two steps: bodies placed, held, added and taken away.

#include "physics/dynamics/dynamics_bodies.h"

#include <array>
#include <cmath>

namespace puckloop::physics {

namespace {

void rest(dBodyID body) {
    dBodySetLinearVel(body, 0, 0, 0);
    dBodySetAngularVel(body, 0, 0, 0);
    dBodyEnable(body);
}

}  // namespace

std::size_t Dynamics::add_fixed(const Shape& shape) {
    const OdeSession session(impl_->ode_warnings);
    impl_->set_fixed(impl_->fixed.emplace_back(), shape);
    impl_->near.forget();
    return impl_->fixed.size() - 1;
}

void Dynamics::place_fixed(std::size_t index, const Shape& shape) {
    const OdeSession session(impl_->ode_warnings);
    impl_->set_fixed(impl_->fixed[index], shape);
    impl_->near.forget();
    // What leant on it or slept beside it may move now.
    for (auto& object : impl_->objects)
        if (object.present) dBodyEnable(object.body);
}

void Dynamics::remove_fixed(std::size_t index) {
    impl_->fixed[index].present = false;
    for (auto& object : impl_->objects)
        if (object.present) dBodyEnable(object.body);
}

void Dynamics::place_object(std::size_t index, double x, double y, double heading, double vx, double vy) {
    const OdeSession session(impl_->ode_warnings);
    auto& object = impl_->objects[index];
    dMatrix3 rotation;
    dRFromAxisAndAngle(rotation, 0, 0, 1, heading);
    dBodySetPosition(object.body, x, y, object.standing_height);
    dBodySetRotation(object.body, rotation);
    rest(object.body);
    dBodySetLinearVel(object.body, vx, vy, 0);
    Impl::read_object(object);
}

void Dynamics::remove_object(std::size_t index) {
    const OdeSession session(impl_->ode_warnings);
    auto& object = impl_->objects[index];
    object.present = false;
    rest(object.body);
    dBodyDisable(object.body);
}

void Dynamics::hold_robot(std::size_t index) {
    const OdeSession session(impl_->ode_warnings);
    auto& robot = impl_->robots[index];
    if (robot.hand != nullptr) return;
    rest(robot.chassis);
    robot.hand = dJointCreateFixed(impl_->world, nullptr);
    dJointAttach(robot.hand, robot.chassis, nullptr);
    dJointSetFixed(robot.hand);
}

void Dynamics::release_robot(std::size_t index) {
    const OdeSession session(impl_->ode_warnings);
    auto& robot = impl_->robots[index];
    if (robot.hand == nullptr) return;
    dJointDestroy(robot.hand);
    robot.hand = nullptr;
}

void Dynamics::place_robot(std::size_t index, double x, double y, double heading) {
    const OdeSession session(impl_->ode_warnings);
    auto& robot = impl_->robots[index];
    const auto& p = robot.parameters;
    const double cosine = std::cos(heading), sine = std::sin(heading);
    dMatrix3 upright, change, wheel;
    dRFromAxisAndAngle(upright, 0, 0, 1, heading);
    dMultiply2_333(change, upright, dBodyGetRotation(robot.chassis));  // upright times the transpose
    for (std::size_t side = 0; side < 2; ++side) {
        const double out = (side == 0 ? 0.5 : -0.5) * p.axle_length;
        dMultiply0_333(wheel, change, dBodyGetRotation(robot.wheel[side]));  // its angle on the axle stays
        dBodySetRotation(robot.wheel[side], wheel);
        dBodySetPosition(robot.wheel[side], x - sine * out, y + cosine * out, robot.wheel_radius[side]);
        rest(robot.wheel[side]);
    }
    dBodySetRotation(robot.chassis, upright);
    dBodySetPosition(robot.chassis, x + cosine * p.com_x, y + sine * p.com_x, p.com_z);
    rest(robot.chassis);
    robot.floor_before = {};
    if (robot.hand != nullptr) dJointSetFixed(robot.hand);
    impl_->read_robot(robot);
}

}  // namespace puckloop::physics
