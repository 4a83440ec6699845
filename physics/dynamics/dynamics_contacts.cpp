// Which bodies touch, where, and how slippery it is there.

#include "physics/dynamics/dynamics_bodies.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace puckloop::physics {

namespace {

constexpr int kMostContacts = 8;

/// At the body's own point, not the floor's: a tyre sunk in by the surface layer still rolls on its full
/// radius.
dContactGeom floor_point(const dReal* point) {
    dContactGeom geom{};
    geom.pos[0] = point[0];
    geom.pos[1] = point[1];
    geom.pos[2] = point[2];
    geom.normal[2] = 1;
    geom.depth = -point[2];
    return geom;
}

/// The floor's velocity at a contact's point, along `forward` and to its left; `more` is forward only.
void carry(const RobotBody& robot, const dReal* point, const dReal* forward, double more,
           dSurfaceParameters& surface) {
    const auto& floor = *robot.floor;
    const double x = floor.x - floor.turn * (point[1] - robot.state.y);
    const double y = floor.y + floor.turn * (point[0] - robot.state.x);
    surface.mode |= dContactMotion1 | dContactMotion2;
    surface.motion1 = x * forward[0] + y * forward[1] + more;
    surface.motion2 = y * forward[0] - x * forward[1];
}

/// Bounding circles apart: nothing to look at.
bool apart(const Shape& a, const Shape& b) {
    const double dx = a.x - b.x;
    const double dy = a.y - b.y;
    const double reach = a.radius + b.radius;
    return dx * dx + dy * dy > reach * reach;
}

}  // namespace

dSurfaceParameters Dynamics::Impl::surface(double mu) const {
    dSurfaceParameters s{};
    s.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
    s.mu = mu;
    s.soft_erp = contact.soft_erp;
    s.soft_cfm = contact.soft_cfm;
    return s;
}

void Dynamics::Impl::add_contact(const dSurfaceParameters& surface, const dContactGeom& geom, dBodyID first,
                                 dBodyID second, const dReal* direction) {
    dContact c{};
    c.surface = surface;
    c.geom = geom;
    if (direction != nullptr) std::copy(direction, direction + 3, c.fdir1);
    dJointAttach(dJointCreateContact(world, contacts, &c), first, second);
}

void Dynamics::Impl::wheels_on_floor(const RobotBody& robot) {
    for (std::size_t side = 0; side < 2; ++side) {
        const dReal* centre = dBodyGetPosition(robot.wheel[side]);
        const dReal* r = dBodyGetRotation(robot.wheel[side]);
        const double ax = r[1], ay = r[5], az = r[9];  // the axle, unit
        const double flat = std::sqrt(1 - std::min(az * az, 0.99));
        const double radius = robot.wheel_radius[side];
        const dReal lowest[3] = {centre[0] + radius * ax * az / flat, centre[1] + radius * ay * az / flat,
                                 centre[2] - radius * flat};
        if (lowest[2] > 0) continue;
        auto s = surface(contact.mu);
        s.mode |= dContactMu2 | dContactFDir1;
        s.mu2 = contact.mu_lateral;
        if (contact.creep > 0) {
            s.mode |= dContactSlip1 | dContactSlip2;
            s.slip1 = s.slip2 = contact.creep;
        }
        const double length = std::hypot(ax, ay);
        const dReal forward[3] = {ay / length, -ax / length, 0};
        if (robot.floor) carry(robot, lowest, forward, robot.floor->forward[side], s);
        add_contact(s, floor_point(lowest), robot.wheel[side], nullptr, forward);
    }
}

void Dynamics::Impl::skids_on_floor(const RobotBody& robot) {
    const auto& p = robot.parameters;
    for (const double end : {p.skid_distance, -p.skid_distance}) {
        dVector3 point;
        dBodyGetRelPointPos(robot.chassis, end - p.com_x, 0, p.skid_clearance - p.com_z, point);
        if (point[2] > 0) continue;
        auto s = surface(contact.mu_skid);
        if (!robot.floor) {
            add_contact(s, floor_point(point), robot.chassis, nullptr);
            continue;
        }
        constexpr dReal kEast[3] = {1, 0, 0};
        s.mode |= dContactFDir1;
        carry(robot, point, kEast, 0.0, s);
        add_contact(s, floor_point(point), robot.chassis, nullptr, kEast);
    }
}

void Dynamics::Impl::object_on_floor(const ObjectBody& object) {
    if (dBodyIsEnabled(object.body) == 0) return;
    dContactGeom geoms[kMostContacts];
    const int count = dCollide(object.geom, floor, kMostContacts, geoms, sizeof(dContactGeom));
    for (int i = 0; i < count; ++i)
        add_contact(surface(contact.mu_object), geoms[i], object.body, nullptr);
}

/// True if they touch.
bool Dynamics::Impl::in_plan(dBodyID body, const Shape& circle, dBodyID other_body, const Shape& other,
                             double mu) {
    const Touch t = touch(other, circle.x, circle.y, circle.radius);
    if (t.depth <= 0) return false;
    dContactGeom geom{};
    geom.pos[0] = t.x;
    geom.pos[1] = t.y;
    geom.pos[2] = std::min({contact.push_height, circle.height / 2, other.height / 2});
    const double sign = body == nullptr ? -1.0 : 1.0;  // the normal points into the first body, which must be
    geom.normal[0] = sign * t.normal_x;
    geom.normal[1] = sign * t.normal_y;
    geom.depth = t.depth;
    if (body == nullptr) std::swap(body, other_body);
    add_contact(surface(mu), geom, body, other_body);
    return true;
}

void Dynamics::Impl::boxes_meet(const ObjectBody& object, dBodyID other_body, dGeomID other) {
    dContactGeom geoms[kMostContacts];
    const int count = dCollide(object.geom, other, kMostContacts, geoms, sizeof(dContactGeom));
    for (int i = 0; i < count; ++i)
        add_contact(surface(contact.mu_object), geoms[i], object.body, other_body);
}

void Dynamics::Impl::refresh_neighbours() {
    const std::size_t count = robots.size() + objects.size();
    const auto shape = [&](std::size_t i) -> const Shape& {
        return i < robots.size() ? robots[i].shape : objects[i - robots.size()].shape;
    };
    if (near.hold(count, shape)) return;
    std::vector<Disc> moving;
    std::vector<double> reach;
    std::vector<const Shape*> still;
    for (std::size_t i = 0; i < count; ++i)
        moving.push_back({shape(i).x, shape(i).y, shape(i).radius});
    for (const RobotBody& robot : robots)
        reach.push_back(robot.shape.radius);
    for (const FixedBody& body : fixed)
        still.push_back(&body.shape);
    near.make(std::move(moving), reach, still);
}

/// Fixed things, then robots with a lower index, then objects.
void Dynamics::Impl::robot_meets_others(std::size_t index) {
    const auto& robot = robots[index];
    const auto meet = [&](RobotContact::Kind kind, std::size_t other, dBodyID body, const Shape& shape) {
        if (!apart(robot.shape, shape) && in_plan(robot.chassis, robot.shape, body, shape, contact.mu_body))
            robot_contacts.push_back({index, kind, other});
    };
    for (const std::uint32_t i : near.fixed(index))
        if (fixed[i].present) meet(RobotContact::Kind::Fixed, i, nullptr, fixed[i].shape);
    for (const std::uint32_t i : near.moving(index)) {
        if (i < index) {
            if (robots[i].hand == nullptr)
                meet(RobotContact::Kind::Robot, i, robots[i].chassis, robots[i].shape);
        } else if (i >= robots.size()) {
            const std::size_t k = i - robots.size();
            if (objects[k].present) meet(RobotContact::Kind::Object, k, objects[k].body, objects[k].shape);
        }
    }
}

void Dynamics::Impl::find_contacts() {
    robot_contacts.clear();
    refresh_neighbours();
    for (std::size_t i = 0; i < robots.size(); ++i) {
        const auto& robot = robots[i];
        if (robot.hand != nullptr) continue;
        wheels_on_floor(robot);
        skids_on_floor(robot);
        robot_meets_others(i);
    }
    for (std::size_t i = 0; i < objects.size(); ++i) {
        const auto& object = objects[i];
        if (!object.present) continue;
        const bool is_box = object.shape.kind == Shape::Kind::Box;
        object_on_floor(object);
        const auto meet = [&](dBodyID body, const Shape& shape, dGeomID geom) {
            if (apart(object.shape, shape)) return;
            if (!is_box)
                in_plan(object.body, object.shape, body, shape, contact.mu_object);
            else if (shape.kind == Shape::Kind::Box)
                boxes_meet(object, body, geom);
            else
                in_plan(body, shape, object.body, object.shape, contact.mu_object);
        };
        for (const auto& thing : fixed)
            if (thing.present) meet(nullptr, thing.shape, thing.geom);
        for (std::size_t j = 0; j < i; ++j)
            if (objects[j].present) meet(objects[j].body, objects[j].shape, objects[j].geom);
    }
}

}  // namespace puckloop::physics
