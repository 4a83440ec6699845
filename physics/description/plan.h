#pragma once
// The world seen from above: upright shapes (circles and turned rectangles with a height), and what rays and
// bodies need of them. Exact plane geometry; no allocation in the queries.

#include "physics/description/description.h"

#include <optional>

namespace puckloop::physics {

/// An upright prism standing on the floor. Circle: `radius`. Box: half sizes along its own axes.
struct Shape {
    enum class Kind : std::uint8_t { Circle, Box };
    Kind kind = Kind::Circle;
    double x = 0.0, y = 0.0;
    double cosine = 1.0, sine = 0.0;  ///< of a box's heading
    double half_length = 0.0, half_width = 0.0;
    double radius = 0.0;  ///< of the circle, or of the circle around the box
    double height = 0.0;
    double reflectivity = 1.0;

    void place(double new_x, double new_y, double heading);
};

Shape circle_shape(double x, double y, double radius, double height, double reflectivity);
Shape box_shape(double x, double y, double heading, double length, double width, double height,
                double reflectivity);

/// Where a line from (x, y) along the unit vector (dx, dy) is inside a shape: `in` <= `out`, metres from the
/// start, both negative when the shape lies behind. `cosine` of incidence at `in`, 0..1.
struct Chord {
    double in = 0.0, out = 0.0, cosine = 1.0;
};
std::optional<Chord> chord(const Shape& shape, double x, double y, double dx, double dy);
/// The same chord, but nothing where it lies behind (`out` < 0) or begins at `limit` or later: what a
/// ray that ends there needs, without the work for shapes that it leaves.
std::optional<Chord> chord_before(const Shape& shape, double x, double y, double dx, double dy, double limit);

/// Is the shape's nearest edge, or its inside, nearer than `reach` to the point?
bool within(const Shape& shape, double x, double y, double reach);

/// Nearest approach of a circle to a shape. `normal` points from the shape to the circle; `depth` > 0 means
/// overlap.
struct Touch {
    double x = 0.0, y = 0.0;  ///< point on the shape's edge
    double normal_x = 1.0, normal_y = 0.0;
    double depth = 0.0;
};
Touch touch(const Shape& shape, double x, double y, double radius);

/// Overlap by more than `tolerance`.
bool overlap(const Shape& a, const Shape& b, double tolerance = 1e-6);

/// Twice the signed area; positive for a counter-clockwise polygon.
double signed_area(const std::vector<Point>& corners);
bool inside(const std::vector<Point>& corners, double x, double y);
/// Distance from a point to the polygon's nearest edge.
double edge_distance(const std::vector<Point>& corners, double x, double y);

/// Arena walls and parts of booths, which nothing moves: the first of a world's fixed shapes.
std::size_t built_in_count(const World& world);
/// The fixed shapes of a world: arena walls, parts of booths, walls, boxes and cylinders that do not move.
std::vector<Shape> fixed_shapes(const World& world);
/// Their names, in the same order.
std::vector<std::string> fixed_names(const World& world);
Shape shape_of(const Wall& wall);
Shape shape_of(const Box& box);
Shape shape_of(const Cylinder& cylinder);

/// A wall, box or cylinder that only robots' proximity sensors meet.
struct VirtualBody {
    std::string name;
    const char* kind = "";  ///< "virtual_wall", ...
    Shape shape;
    std::vector<std::string> robots;  ///< who senses it; empty: all
    bool by_hand = false;             ///< has been moved or added since the start

    bool sensed_by(std::string_view robot) const { return includes_robot(robots, robot); }
};
std::vector<VirtualBody> virtual_bodies(const VirtualThings& things);
std::vector<Shape> arena_walls(const Arena& arena);

}  // namespace puckloop::physics
