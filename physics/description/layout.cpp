// From the description to plan shapes: arena polygon, walls, fixed things.

#include "physics/description/booth.h"
#include "physics/description/plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

/// A wall `thickness` wide along a counter-clockwise edge, outside it, lengthened at both ends so that
/// convex corners close.
Shape edge_wall(const Point& from, const Point& to, const Arena& arena) {
    const double length = std::hypot(to.x - from.x, to.y - from.y);
    const double ux = (to.x - from.x) / length;
    const double uy = (to.y - from.y) / length;
    const double out = arena.wall_thickness / 2;
    return box_shape((from.x + to.x) / 2 + uy * out, (from.y + to.y) / 2 - ux * out, std::atan2(uy, ux),
                     length + 2 * arena.wall_thickness, arena.wall_thickness, arena.wall_height,
                     arena.reflectivity);
}

/// As edge_wall, without reaching past a reflex corner into the arena.
Shape trimmed_wall(const Arena& arena, const std::vector<Point>& corners, std::size_t i) {
    const auto n = corners.size();
    const auto turn = [&](std::size_t k) {  // > 0: convex corner
        const Point& a = corners[(k + n - 1) % n];
        const Point& b = corners[k % n];
        const Point& c = corners[(k + 1) % n];
        return (b.x - a.x) * (c.y - b.y) - (b.y - a.y) * (c.x - b.x);
    };
    Shape wall = edge_wall(corners[i], corners[(i + 1) % n], arena);
    const double cut_start = turn(i) < 0 ? arena.wall_thickness : 0.0;
    const double cut_end = turn(i + 1) < 0 ? arena.wall_thickness : 0.0;
    wall.half_length -= (cut_start + cut_end) / 2;
    wall.x += wall.cosine * (cut_start - cut_end) / 2;
    wall.y += wall.sine * (cut_start - cut_end) / 2;
    return wall;
}

}  // namespace

Arena rectangular_arena(double width, double depth) {
    Arena arena;
    arena.corners = {
        {-width / 2, -depth / 2}, {width / 2, -depth / 2}, {width / 2, depth / 2}, {-width / 2, depth / 2}};
    return arena;
}

double signed_area(const std::vector<Point>& corners) {
    double sum = 0.0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point& a = corners[i];
        const Point& b = corners[(i + 1) % corners.size()];
        sum += a.x * b.y - b.x * a.y;
    }
    return sum;
}

bool inside(const std::vector<Point>& corners, double x, double y) {
    bool in = false;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point& a = corners[i];
        const Point& b = corners[(i + 1) % corners.size()];
        if ((a.y > y) != (b.y > y) && x < (b.x - a.x) * (y - a.y) / (b.y - a.y) + a.x) in = !in;
    }
    return in;
}

double edge_distance(const std::vector<Point>& corners, double x, double y) {
    double best = 1e9;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point& a = corners[i];
        const Point& b = corners[(i + 1) % corners.size()];
        const double dx = b.x - a.x;
        const double dy = b.y - a.y;
        const double t = std::clamp(((x - a.x) * dx + (y - a.y) * dy) / (dx * dx + dy * dy), 0.0, 1.0);
        best = std::min(best, std::hypot(x - a.x - t * dx, y - a.y - t * dy));
    }
    return best;
}

Shape shape_of(const Wall& w) {
    return box_shape((w.from.x + w.to.x) / 2, (w.from.y + w.to.y) / 2,
                     std::atan2(w.to.y - w.from.y, w.to.x - w.from.x),
                     std::hypot(w.to.x - w.from.x, w.to.y - w.from.y), w.thickness, w.height, w.reflectivity);
}

Shape shape_of(const Box& b) {
    return box_shape(b.x, b.y, b.heading, b.length, b.width, b.height, b.reflectivity);
}

Shape shape_of(const Cylinder& c) {
    return circle_shape(c.x, c.y, c.radius, c.height, c.reflectivity);
}

std::vector<Shape> arena_walls(const Arena& arena) {
    std::vector<Shape> walls;
    if (!arena.walls) return walls;
    auto corners = arena.corners;
    if (signed_area(corners) < 0) std::reverse(corners.begin(), corners.end());
    for (std::size_t i = 0; i < corners.size(); ++i)
        walls.push_back(trimmed_wall(arena, corners, i));
    return walls;
}

std::size_t built_in_count(const World& world) {
    return arena_walls(world.arena).size() + world.booths.size() * booth::kParts;
}

std::vector<Shape> fixed_shapes(const World& world) {
    auto shapes = arena_walls(world.arena);
    for (const Booth& booth : world.booths)
        for (const Shape& part : shapes_of(booth))
            shapes.push_back(part);
    for (const auto& wall : world.walls)
        shapes.push_back(shape_of(wall));
    for (const auto& box : world.boxes)
        if (!box.movable) shapes.push_back(shape_of(box));
    for (const auto& cylinder : world.cylinders)
        if (!cylinder.movable) shapes.push_back(shape_of(cylinder));
    return shapes;
}

std::vector<std::string> fixed_names(const World& world) {
    std::vector<std::string> names;
    const auto add = [&](const std::string& name, const char* kind, std::size_t index) {
        names.push_back(name.empty() ? kind + std::to_string(index) : name);
    };
    for (std::size_t i = 0; i < arena_walls(world.arena).size(); ++i)
        add({}, "arena wall ", i);
    for (const Booth& booth : world.booths)
        for (const std::string& part : part_names(booth))
            names.push_back(part);
    for (std::size_t i = 0; i < world.walls.size(); ++i)
        add(world.walls[i].name, "wall ", i);
    for (std::size_t i = 0; i < world.boxes.size(); ++i)
        if (!world.boxes[i].movable) add(world.boxes[i].name, "box ", i);
    for (std::size_t i = 0; i < world.cylinders.size(); ++i)
        if (!world.cylinders[i].movable) add(world.cylinders[i].name, "cylinder ", i);
    return names;
}

}  // namespace puckloop::physics
