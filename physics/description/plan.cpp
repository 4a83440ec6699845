#include "physics/description/plan.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

struct Local {
    double x, y;
};

Local to_local(const Shape& s, double x, double y) {
    return {s.cosine * (x - s.x) + s.sine * (y - s.y), -s.sine * (x - s.x) + s.cosine * (y - s.y)};
}

/// Part of a line inside |coordinate| <= half; false when it never is. `entry_cosine` is updated with `in`.
bool clip(double start, double direction, double half, Chord& c) {
    if (std::abs(direction) < 1e-12) return std::abs(start) <= half;
    double near = (-half - start) / direction;
    double far = (half - start) / direction;
    if (near > far) std::swap(near, far);
    if (near > c.in) {
        c.in = near;
        c.cosine = std::abs(direction);
    }
    c.out = std::min(c.out, far);
    return c.in <= c.out;
}

/// Is the line outside on this axis and goes on outwards, so that all of it that is inside lies behind?
bool leaves(double start, double direction, double half) {
    return (start > half && direction >= 0.0) || (start < -half && direction <= 0.0);
}

Touch touch_circle(const Shape& s, double x, double y, double radius) {
    const double dx = x - s.x;
    const double dy = y - s.y;
    const double distance = std::hypot(dx, dy);
    Touch t;
    if (distance > 1e-12) {
        t.normal_x = dx / distance;
        t.normal_y = dy / distance;
    }
    t.depth = radius + s.radius - distance;
    t.x = s.x + t.normal_x * s.radius;
    t.y = s.y + t.normal_y * s.radius;
    return t;
}

Touch touch_box(const Shape& s, double x, double y, double radius) {
    const Local p = to_local(s, x, y);
    Local edge{std::clamp(p.x, -s.half_length, s.half_length), std::clamp(p.y, -s.half_width, s.half_width)};
    Local normal{p.x - edge.x, p.y - edge.y};
    const double distance = std::hypot(normal.x, normal.y);
    Touch t;
    if (distance > 1e-12) {
        normal = {normal.x / distance, normal.y / distance};
        t.depth = radius - distance;
    } else {  // the circle's centre is inside: out through the nearest face
        const double to_x = s.half_length - std::abs(p.x);
        const double to_y = s.half_width - std::abs(p.y);
        if (to_x < to_y) {
            normal = {p.x < 0 ? -1.0 : 1.0, 0.0};
            edge = {normal.x * s.half_length, p.y};
        } else {
            normal = {0.0, p.y < 0 ? -1.0 : 1.0};
            edge = {p.x, normal.y * s.half_width};
        }
        t.depth = radius + std::min(to_x, to_y);
    }
    t.normal_x = s.cosine * normal.x - s.sine * normal.y;
    t.normal_y = s.sine * normal.x + s.cosine * normal.y;
    t.x = s.x + s.cosine * edge.x - s.sine * edge.y;
    t.y = s.y + s.sine * edge.x + s.cosine * edge.y;
    return t;
}

/// Do the boxes' shadows on the axes of `a` overlap?
bool shadows_overlap(const Shape& a, const Shape& b, double tolerance) {
    const Local centre = to_local(a, b.x, b.y);
    const double cosine = std::abs(a.cosine * b.cosine + a.sine * b.sine);
    const double sine = std::abs(a.cosine * b.sine - a.sine * b.cosine);
    return std::abs(centre.x) < a.half_length + b.half_length * cosine + b.half_width * sine - tolerance &&
           std::abs(centre.y) < a.half_width + b.half_length * sine + b.half_width * cosine - tolerance;
}

}  // namespace

void Shape::place(double new_x, double new_y, double heading) {
    x = new_x;
    y = new_y;
    cosine = std::cos(heading);
    sine = std::sin(heading);
}

Shape circle_shape(double x, double y, double radius, double height, double reflectivity) {
    Shape s;
    s.x = x;
    s.y = y;
    s.radius = radius;
    s.height = height;
    s.reflectivity = reflectivity;
    return s;
}

Shape box_shape(double x, double y, double heading, double length, double width, double height,
                double reflectivity) {
    Shape s = circle_shape(x, y, std::hypot(length, width) / 2, height, reflectivity);
    s.kind = Shape::Kind::Box;
    s.half_length = length / 2;
    s.half_width = width / 2;
    s.place(x, y, heading);
    return s;
}

std::optional<Chord> chord(const Shape& s, double x, double y, double dx, double dy) {
    const double along = (s.x - x) * dx + (s.y - y) * dy;
    const double across = (s.x - x) * dy - (s.y - y) * dx;
    const double rest = s.radius * s.radius - across * across;
    if (rest <= 0.0) return std::nullopt;
    const double half = std::sqrt(rest);
    if (s.kind == Shape::Kind::Circle) return Chord{along - half, along + half, half / s.radius};
    const Local start = to_local(s, x, y);
    const Local direction{s.cosine * dx + s.sine * dy, -s.sine * dx + s.cosine * dy};
    Chord c{-1e9, 1e9, 1.0};
    if (!clip(start.x, direction.x, s.half_length, c) || !clip(start.y, direction.y, s.half_width, c))
        return std::nullopt;
    return c;
}

std::optional<Chord> chord_before(const Shape& s, double x, double y, double dx, double dy, double limit) {
    if (s.kind == Shape::Kind::Box) {
        const Local start = to_local(s, x, y);
        const Local direction{s.cosine * dx + s.sine * dy, -s.sine * dx + s.cosine * dy};
        if (leaves(start.x, direction.x, s.half_length) || leaves(start.y, direction.y, s.half_width))
            return std::nullopt;
    }
    const auto hit = chord(s, x, y, dx, dy);
    if (!hit || hit->out < 0.0 || hit->in >= limit) return std::nullopt;
    return hit;
}

bool within(const Shape& s, double x, double y, double reach) {
    const double dx = s.x - x, dy = s.y - y;
    const double far = reach + s.radius;
    if (dx * dx + dy * dy >= far * far) return false;
    if (s.kind == Shape::Kind::Circle) return true;
    const Local p = to_local(s, x, y);
    const double beyond_x = std::max(std::abs(p.x) - s.half_length, 0.0);
    const double beyond_y = std::max(std::abs(p.y) - s.half_width, 0.0);
    return beyond_x * beyond_x + beyond_y * beyond_y < reach * reach;
}

Touch touch(const Shape& s, double x, double y, double radius) {
    return s.kind == Shape::Kind::Circle ? touch_circle(s, x, y, radius) : touch_box(s, x, y, radius);
}

bool overlap(const Shape& a, const Shape& b, double tolerance) {
    if (b.kind == Shape::Kind::Circle) return touch(a, b.x, b.y, b.radius).depth > tolerance;
    if (a.kind == Shape::Kind::Circle) return touch(b, a.x, a.y, a.radius).depth > tolerance;
    return shadows_overlap(a, b, tolerance) && shadows_overlap(b, a, tolerance);
}

std::vector<VirtualBody> virtual_bodies(const VirtualThings& things) {
    std::vector<VirtualBody> bodies;
    const auto add = [&](const auto& list, const char* kind) {
        for (const auto& thing : list)
            bodies.push_back({thing.name, kind, shape_of(thing), thing.robots});
    };
    add(things.walls, "virtual_wall");
    add(things.boxes, "virtual_box");
    add(things.cylinders, "virtual_cylinder");
    return bodies;
}

std::vector<Lamp> lamps_sensed_by(const World& world, std::string_view robot) {
    std::vector<Lamp> lamps = world.lamps;
    for (const auto& lamp : world.virtuals.lamps)
        if (lamp.sensed_by(robot)) lamps.push_back(lamp);
    return lamps;
}

}  // namespace puckloop::physics
