// Is a described world possible? Every refusal names the element, and where the user wrote it.

#include "base/error.h"
#include "physics/description/booth.h"
#include "physics/description/parameters.h"
#include "physics/description/plan.h"
#include "physics/description/robot_parameters.h"
#include "physics/description/trail_cells.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <stdexcept>

namespace puckloop::physics {

namespace {

constexpr double kFarthest = 1000.0;      // m: nothing is further out or bigger
constexpr double kMostReflective = 10.0;  // foil is 1.5
constexpr double kBrightest = 100.0;
constexpr double kLoudest = 1e5;            // counts: full scale 2 m away
constexpr double kLongest = 1e9;            // s
constexpr std::size_t kMostData = 4;        // bytes of a frame
constexpr double kShortestTurn = 0.02;      // s: a frame of 4 bytes lasts 7.7 ms
constexpr double kWidestTrail = 0.5;        // m
constexpr double kShortestHalfLife = 0.01;  // s
constexpr double kLowest = 20,
                 kHighest = 4000;  // Hz: what microphones hear evenly here (physics/sensors/sound_waves.h)

class Checker {
  public:
    explicit Checker(const World& world) : world_(world) {}

    void run() {
        check_parameters("parameters", {}, world_.parameters, false);
        check_extension();
        range("world", {}, "ambient_light", world_.ambient_light, 0.0, kBrightest);
        check_arena();
        for (const auto& w : world_.walls)
            check_wall(w);
        for (const auto& b : world_.boxes)
            check_box(b);
        for (const auto& c : world_.cylinders)
            check_cylinder(c);
        for (const auto& l : world_.lamps)
            check_lamp("lamp", l);
        for (const auto& s : world_.speakers)
            check_speaker(s);
        for (const auto& p : world_.patches)
            check_patch(p);
        for (const auto& b : world_.booths)
            check_booth(b);
        check_booths_apart();
        check_virtuals();
        check_robots();
        check_bodies();
        check_recording();
    }

  private:
    struct Body {
        std::string what;
        Place place;
        Shape shape;
    };

    [[noreturn]] void fail(const std::string& what, const Place& place, const std::string& problem,
                           const std::string& expected = {}) const {
        throw InputError(world_.file, place, what + ": " + problem, expected);
    }
    void range(const std::string& what, const Place& place, const char* field, double value, double low,
               double high) const {
        if (!std::isfinite(value) || value < low || value > high)
            fail(what, place, fmt::format("{} = {}", field, value), fmt::format("{} to {}", low, high));
    }
    void size(const std::string& what, const Place& place, const char* field, double value) const {
        if (!std::isfinite(value) || value <= 0.0 || value > kFarthest)
            fail(what, place, fmt::format("{} = {}", field, value), "a length above zero");
    }
    void position(const std::string& what, const Place& place, double x, double y, double heading = 0) const {
        range(what, place, "x", x, -kFarthest, kFarthest);
        range(what, place, "y", y, -kFarthest, kFarthest);
        range(what, place, "heading", heading, -kFarthest, kFarthest);
    }
    std::string named(const char* kind, const std::string& name, const Place& place) {
        const std::string what = fmt::format("{} '{}'", kind, name);
        if (name.empty()) fail(std::string(kind), place, "has no name", "a name");
        if (name.find_first_of(",\"\r\n") != std::string::npos)
            fail(what, place, "a name goes into CSV files", "no comma, quote or line end in it");
        if (!names_.insert(name).second) fail(what, place, "the name is already taken", "different names");
        return what;
    }
    void check_parameters(const std::string& what, const Place& place,
                          const std::map<std::string, double>& values, bool of_robot) const {
        Parameters scratch;
        for (const auto& [name, value] : values) {
            try {
                scratch.set(name, value);
            } catch (const std::invalid_argument& error) {
                fail(what, place, error.what());
            }
            int index = -1;
            if (of_robot && !find_parameter(name, index)->of_robot())
                fail(what, place, fmt::format("parameter {} holds for the whole world", name),
                     "it among the world's parameters");
        }
    }
    void check_arena() const {
        const auto& a = world_.arena;
        if (a.corners.size() < 3)
            fail("arena", a.place, fmt::format("has {} corners", a.corners.size()), "three or more");
        for (const auto& corner : a.corners)
            position("arena", a.place, corner.x, corner.y);
        const auto n = a.corners.size();
        for (std::size_t i = 0; i < n; ++i)
            if (std::hypot(a.corners[i].x - a.corners[(i + 1) % n].x,
                           a.corners[i].y - a.corners[(i + 1) % n].y) < 1e-6)
                fail("arena", a.place, fmt::format("corners {} and {} coincide", i + 1, (i + 1) % n + 1));
        for (std::size_t i = 0; i < n; ++i)
            for (std::size_t j = i + 2; j < n; ++j)
                if ((j + 1) % n != i && edges_cross(i, j))
                    fail("arena", a.place, fmt::format("edges {} and {} cross", i + 1, j + 1),
                         "a simple polygon");
        if (std::abs(signed_area(a.corners)) < 1e-4) fail("arena", a.place, "has no area");
        range("arena", a.place, "floor_grey", a.floor_grey, 0.0, 1.0);
        range("arena", a.place, "reflectivity", a.reflectivity, 0.0, kMostReflective);
        size("arena", a.place, "wall_height", a.wall_height);
        size("arena", a.place, "wall_thickness", a.wall_thickness);
    }
    bool edges_cross(std::size_t i, std::size_t j) const {
        const auto& c = world_.arena.corners;
        const auto side = [](const Point& p, const Point& q, const Point& r) {
            return (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
        };
        const auto &a = c[i], &b = c[(i + 1) % c.size()], &p = c[j], &q = c[(j + 1) % c.size()];
        return side(a, b, p) * side(a, b, q) < 0 && side(p, q, a) * side(p, q, b) < 0;
    }
    std::string wall_sizes(const char* kind, const Wall& w) {
        auto what = named(kind, w.name, w.place);
        position(what, w.place, w.from.x, w.from.y);
        position(what, w.place, w.to.x, w.to.y);
        size(what, w.place, "length", std::hypot(w.to.x - w.from.x, w.to.y - w.from.y));
        size(what, w.place, "thickness", w.thickness);
        size(what, w.place, "height", w.height);
        range(what, w.place, "reflectivity", w.reflectivity, 0.0, kMostReflective);
        return what;
    }
    void check_wall(const Wall& w) {
        const auto what = wall_sizes("wall", w);
        fixed_.push_back({what, w.place, shape_of(w)});
    }
    std::string box_sizes(const char* kind, const Box& b) {
        auto what = named(kind, b.name, b.place);
        position(what, b.place, b.x, b.y, b.heading);
        size(what, b.place, "length", b.length);
        size(what, b.place, "width", b.width);
        size(what, b.place, "height", b.height);
        range(what, b.place, "reflectivity", b.reflectivity, 0.0, kMostReflective);
        return what;
    }
    void check_box(const Box& b) { solid(box_sizes("box", b), b, shape_of(b)); }
    std::string cylinder_sizes(const char* kind, const Cylinder& c) {
        auto what = named(kind, c.name, c.place);
        position(what, c.place, c.x, c.y);
        size(what, c.place, "radius", c.radius);
        size(what, c.place, "height", c.height);
        range(what, c.place, "reflectivity", c.reflectivity, 0.0, kMostReflective);
        return what;
    }
    void check_cylinder(const Cylinder& c) { solid(cylinder_sizes("cylinder", c), c, shape_of(c)); }
    template <class Thing>
    void solid(const std::string& what, const Thing& thing, const Shape& shape) {
        if (thing.movable) range(what, thing.place, "mass", thing.mass, 1e-3, 100.0);
        if (!thing.movable && !reaches_arena(shape))
            fail(what, thing.place, fmt::format("({} m, {} m) is outside the arena", shape.x, shape.y));
        (thing.movable ? moving_ : fixed_).push_back({what, thing.place, shape});
    }
    /// A convex shape that no edge meets is inside or outside as a whole.
    bool reaches_arena(const Shape& shape) const {
        const auto& corners = world_.arena.corners;
        if (inside(corners, shape.x, shape.y)) return true;
        for (std::size_t i = 0; i < corners.size(); ++i) {
            const Point &from = corners[i], &to = corners[(i + 1) % corners.size()];
            const double length = std::hypot(to.x - from.x, to.y - from.y);
            const auto met = chord(shape, from.x, from.y, (to.x - from.x) / length, (to.y - from.y) / length);
            if (met && met->out >= 0.0 && met->in <= length) return true;
        }
        return false;
    }
    void check_lamp(const char* kind, const Lamp& l) {
        const auto what = named(kind, l.name, l.place);
        position(what, l.place, l.x, l.y);
        range(what, l.place, "height", l.height, 0.0, kFarthest);
        range(what, l.place, "intensity", l.intensity, 0.0, kBrightest);
    }
    void check_speaker(const Speaker& s) {
        const auto what = named("speaker", s.name, s.place);
        position(what, s.place, s.x, s.y);
        range(what, s.place, "height", s.height, 0.0, kFarthest);
        range(what, s.place, "level", s.level, 0.0, kLoudest);
        range(what, s.place, "on", s.on, 0.0, kLongest);
        range(what, s.place, "off", s.off, s.on, kLongest);
        if (s.every != 0.0) range(what, s.place, "every", s.every, std::max(s.off - s.on, 1e-3), kLongest);
        if (s.tone != 0.0) range(what, s.place, "tone", s.tone, kLowest, kHighest);
        if (s.sweep_to != 0.0) range(what, s.place, "sweep_to", s.sweep_to, kLowest, kHighest);
    }
    void check_patch(const Patch& p) {
        const auto what = named("patch", p.name, p.place);
        position(what, p.place, p.x, p.y, p.heading);
        range(what, p.place, "grey", p.grey, 0.0, 1.0);
        if (p.shape == Patch::Shape::Disc) {
            size(what, p.place, "radius", p.radius);
        } else {
            size(what, p.place, "length", p.length);
            size(what, p.place, "width", p.width);
        }
    }
    /// They may be anywhere, in each other too.
    void check_virtuals() {
        const VirtualThings& things = world_.virtuals;
        for (const auto& w : things.walls)
            wall_sizes("virtual_wall", w);
        for (const auto& b : things.boxes)
            box_sizes("virtual_box", b);
        for (const auto& c : things.cylinders)
            cylinder_sizes("virtual_cylinder", c);
        for (const auto& l : things.lamps)
            check_lamp("virtual_lamp", l);
        for (const auto& p : things.pheromones)
            check_pheromone(p);
        if (things.boards.size() > kMostVirtualBoards)
            fail("virtual_board", things.boards.back().place,
                 fmt::format("there are {} virtual boards", things.boards.size()),
                 fmt::format("at most {}", kMostVirtualBoards));
        for (const auto& b : things.boards)
            check_virtual_board(b);
    }
    void check_virtual_board(const VirtualBoard& b) {
        const auto what = named("virtual_board", b.name, b.place);
        position(what, b.place, b.x, b.y, b.heading);
        if (b.data.empty() || b.data.size() > kMostData)
            fail(what, b.place, fmt::format("data has {} bytes", b.data.size()), "1 to 4 bytes");
        range(what, b.place, "power", b.power, 0.0, 255.0);
        range(what, b.place, "begin", b.begin, 0.0, kLongest);
        range(what, b.place, "every", b.every, kShortestTurn, kLongest);
        range(what, b.place, "jitter", b.jitter, 0.0, kLongest);
        if (std::none_of(world_.robots.begin(), world_.robots.end(), [](const Robot& r) { return r.rab; }))
            fail(what, b.place, "no robot has a range-and-bearing board that could hear it",
                 "[robot.rab] of a robot");
    }
    void check_pheromone(const Pheromone& p) {
        const auto what = named("pheromone", p.name, p.place);
        range(what, p.place, "radius", p.radius, 1e-3, kWidestTrail);
        range(what, p.place, "fill_time", p.fill_time, 1e-3, kLongest);
        range(what, p.place, "half_life", p.half_life, 0.0, kLongest);
        if (p.half_life > 0.0) range(what, p.place, "half_life", p.half_life, kShortestHalfLife, kLongest);
        range(what, p.place, "grey", p.grey, 0.0, 1.0);
        range(what, p.place, "cell", p.cell, 1e-3, 1.0);
        if (p.record_every != 0.0)
            range(what, p.place, "record_every", p.record_every, kSpreadInterval / 10, kLongest);
        const TrailCells cells = trail_cells(p, world_.arena);
        if (cells.columns * cells.rows > kMostTrailCells)
            fail(what, p.place,
                 fmt::format("cell = {:g} m makes {:.0f} x {:.0f} squares of this arena", p.cell,
                             cells.columns, cells.rows),
                 fmt::format("at most {:.0f}: a larger cell", kMostTrailCells));
        range(what, p.place, "diffusion", p.diffusion, 0.0, kMostSpread * p.cell * p.cell / kSpreadInterval);
    }
    void check_booth(const Booth& b) {
        const auto what = named("tam", b.name, b.place);
        position(what, b.place, b.x, b.y, b.heading);
        range(what, b.place, "reflectivity", b.reflectivity, 0.0, kMostReflective);
        for (const Shape& part : shapes_of(b))
            fixed_.push_back({what, b.place, part});
        booths_.push_back(
            {what, b.place, box_shape(b.x, b.y, b.heading, booth::kSize, booth::kSize, booth::kSize, 1.0)});
    }
    /// A booth may stand against a wall, and not in one or in another booth.
    void check_booths_apart() const {
        constexpr double kTouch = 1e-4;  // m
        for (std::size_t i = 0; i < booths_.size(); ++i) {
            const Body& b = booths_[i];
            if (!inside(world_.arena.corners, b.shape.x, b.shape.y))
                fail(b.what, b.place, fmt::format("({} m, {} m) is outside the arena", b.shape.x, b.shape.y));
            for (const auto& wall : arena_walls(world_.arena))
                if (overlap(b.shape, wall, kTouch)) fail(b.what, b.place, "is in the arena's wall");
            for (std::size_t j = 0; j < i; ++j)
                if (overlap(b.shape, booths_[j].shape, kTouch))
                    fail(b.what, b.place, "overlaps " + booths_[j].what, "a free place");
        }
    }
    void check_mirror(const std::string& what, const Robot& r, const CameraParameters& camera) const {
        // A hyperboloid reflects nothing that looks up more steeply than its asymptote.
        if (r.camera && std::sin(camera.rim_elevation) >= 1 / camera.eccentricity)
            fail(what, r.place,
                 fmt::format(
                     "no mirror of eccentricity {} sees {} rad above the horizon (camera.rim_elevation)",
                     camera.eccentricity, camera.rim_elevation),
                 fmt::format("less than {:.3g} rad", std::asin(1 / camera.eccentricity)));
    }
    void check_robots() {
        for (const auto& r : world_.robots) {
            const auto what = named("robot", r.name, r.place);
            position(what, r.place, r.x, r.y, r.heading);
            check_parameters(what, r.place, r.parameters, true);
            const Parameters parameters = parameters_of(world_, r);
            const auto& b = parameters.robot;
            check_mirror(what, r, parameters.camera);
            moving_.push_back({what, r.place, circle_shape(r.x, r.y, b.radius, b.height, b.reflectivity)});
            if (b.com_z >= b.height) fail(what, r.place, "robot.com_z is above robot.height");
            const auto& path = parameters.ir.distance;
            if (r.rab && std::adjacent_find(path.begin(), path.end(), std::greater_equal<>()) != path.end())
                fail(what, r.place, "ir.distance does not rise from point to point");
        }
    }
    void check_bodies() const {
        const auto& corners = world_.arena.corners;
        for (const auto& body : moving_)
            if (!inside(corners, body.shape.x, body.shape.y))
                fail(body.what, body.place,
                     fmt::format("({} m, {} m) is outside the arena", body.shape.x, body.shape.y));
        for (std::size_t i = 0; i < moving_.size(); ++i) {
            const auto& body = moving_[i];
            for (const auto& wall : arena_walls(world_.arena))
                if (overlap(body.shape, wall)) fail(body.what, body.place, "is in the arena's wall");
            for (const auto& other : fixed_)
                no_overlap(body, other);
            for (std::size_t j = 0; j < i; ++j)
                no_overlap(body, moving_[j]);
        }
    }
    void no_overlap(const Body& body, const Body& other) const {
        if (overlap(body.shape, other.shape))
            fail(body.what, body.place, "overlaps " + other.what, "a free place");
    }
    void check_extension() const {
        for (const ExtensionTerm& term : world_.extension)
            if (const auto wrong = problem_of(term)) fail("extension", {}, wrong->problem, wrong->expected);
    }
    void check_recording() const {
        const double steps = world_.recording.period * 1e3;
        if (!(steps >= 1.0) || steps > 3.6e6 || std::abs(steps - std::round(steps)) > 1e-6)
            fail("recording", {}, fmt::format("period = {} s", world_.recording.period),
                 "a multiple of 0.001 s, at most an hour");
    }

    const World& world_;
    std::set<std::string> names_;
    std::vector<Body> fixed_, moving_, booths_;
};

}  // namespace

void check(const World& world) {
    check_things(world);
    check_who_senses(world.virtuals, world.robots, world.file);
}

void check_things(const World& world) {
    Checker(world).run();
}

void check_who_senses(const VirtualThings& things, const std::vector<Robot>& robots,
                      const std::string& file) {
    const auto each = [&](const auto& list, const char* kind) {
        for (const auto& thing : list)
            for (const std::string& name : thing.robots)
                if (std::none_of(robots.begin(), robots.end(),
                                 [&](const Robot& robot) { return robot.name == name; }))
                    throw InputError(file, thing.place,
                                     fmt::format("{} '{}': there is no robot '{}'", kind, thing.name, name),
                                     "names of robots in this scenario");
    };
    each(things.walls, "virtual_wall");
    each(things.boxes, "virtual_box");
    each(things.cylinders, "virtual_cylinder");
    each(things.lamps, "virtual_lamp");
    each(things.pheromones, "pheromone");
}

}  // namespace puckloop::physics
