#include "scenarios/reader/compose/placement.h"

#include "physics/description/robot_parameters.h"
#include "scenarios/reader/compose/spread.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::scenarios {

namespace {

constexpr double kTurn = 2 * std::numbers::pi;
constexpr std::size_t kMostUnits = 1000;

physics::Point point_of(Reader& reader, const char* key) {
    const auto values = reader.quantities(key, Dimension::Length, 2);
    return {values[0], values[1]};
}

double positive(Reader& reader, const char* key) {
    const double value = reader.quantity(key, Dimension::Length);
    if (!(value > 0.0 && value <= 1000.0))
        reader.fail(key, fmt::format("{} is out of range", key), "more than 0 m, at most 1000 m");
    return value;
}

/// Tenths of a millimetre: what is drawn can be written down and read again.
double rounded(double metres) {
    return std::round(metres * 1e4) / 1e4;
}

}  // namespace

Placement::Placement(const std::string& file, const std::string& group, const TomlValue* table,
                     const physics::Arena& arena, std::uint64_t seed)
    : arena_(arena), random_(seed, "place " + group), file_(file), group_(group) {
    if (table == nullptr) return;
    Reader reader(file, group + ".place", *table);
    line_ = table->line;
    read(reader);
    reader.finish();
}

void Placement::read(Reader& reader) {
    const std::string kind =
        reader.choice("kind", "arena", {"arena", "disc", "rectangle", "normal", "grid", "ring", "list"});
    kind_ = kind == "arena"       ? Kind::Arena
            : kind == "disc"      ? Kind::Disc
            : kind == "rectangle" ? Kind::Rectangle
            : kind == "normal"    ? Kind::Normal
            : kind == "grid"      ? Kind::Grid
            : kind == "ring"      ? Kind::Ring
                                  : Kind::List;
    if (kind_ != Kind::Arena && kind_ != Kind::List && reader.has("centre"))
        centre_ = point_of(reader, "centre");
    if (kind_ == Kind::Disc || kind_ == Kind::Ring) radius_ = positive(reader, "radius");
    if (kind_ == Kind::Ring) start_ = reader.quantity("start", Dimension::Angle, 0.0);
    if (kind_ == Kind::Rectangle) size_ = point_of(reader, "size");
    if (kind_ == Kind::Normal) size_ = point_of(reader, "deviation");
    if (kind_ == Kind::Rectangle || kind_ == Kind::Normal)
        if (!(size_.x >= 0.0 && size_.y >= 0.0 && size_.x <= 1000.0 && size_.y <= 1000.0))
            reader.fail(kind_ == Kind::Normal ? "deviation" : "size", "a length is below 0", "two lengths");
    if (kind_ == Kind::Grid) {
        size_ = point_of(reader, "distance");
        columns_ = static_cast<std::size_t>(reader.integer("columns", 0, 1, kMostUnits));
        rows_ = static_cast<std::size_t>(reader.integer("rows", 0, 1, kMostUnits));
        if (columns_ == 0 || rows_ == 0)
            reader.fail_missing(columns_ == 0 ? "columns" : "rows", "columns = 5, rows = 4");
    }
    if (kind_ == Kind::List) read_list(reader);
    read_heading(reader);
    if (is_drawn()) {
        max_trials_ = static_cast<std::size_t>(reader.integer("max_trials", 1000, 1, 1'000'000));
        gap_ = reader.quantity("gap", Dimension::Length, 0.0);
        if (!(gap_ >= 0.0 && gap_ <= 100.0)) reader.fail("gap", "gap is out of range", "0 m to 100 m");
    }
}

void Placement::read_list(Reader& reader) {
    for (const auto& place : reader.quantity_lists("positions", Dimension::Length, 2))
        list_.push_back({place[0], place[1], 0.0});
    if (list_.empty() || list_.size() > kMostUnits)
        reader.fail("positions", "positions is empty or too long", "1 to 1000 positions");
    if (!reader.has("headings")) return;
    const auto headings = reader.quantities("headings", Dimension::Angle, list_.size());
    for (std::size_t i = 0; i < list_.size(); ++i)
        list_[i].heading = headings[i];
    if (reader.has("heading")) reader.fail("heading", "headings is given as well", "one of them");
}

void Placement::read_heading(Reader& reader) {
    heading_ = is_drawn() ? Heading::Drawn : kind_ == Kind::Ring ? Heading::Outward : Heading::Fixed;
    if (!reader.has("heading")) return;
    const std::string text = reader.text("heading");
    RandomStream trial(1, "");
    try {
        if (drawn(text, trial)) {
            heading_ = Heading::Spread;
            heading_spread_ = text;
            // An angle in both bounds, however it is drawn.
            parse_quantity(std::get<std::string>(drawn(text, trial)->data), Dimension::Angle);
            return;
        }
    } catch (const SpreadError& error) {
        reader.fail("heading", error.problem, error.expected);
    } catch (const QuantityError& error) {
        reader.fail("heading", "heading: " + error.problem, error.expected);
    } catch (const std::bad_variant_access&) {
        reader.fail("heading", "heading has no unit", "\"uniform(0 deg, 360 deg)\"");
    }
    if (kind_ == Kind::Ring && (text == "out" || text == "in")) {
        heading_ = text == "out" ? Heading::Outward : Heading::Inward;
        return;
    }
    heading_ = Heading::Fixed;
    fixed_heading_ = reader.quantity("heading", Dimension::Angle);
}

std::optional<std::size_t> Placement::count() const {
    if (kind_ == Kind::List) return list_.size();
    return std::nullopt;
}

bool Placement::is_drawn() const {
    return kind_ == Kind::Arena || kind_ == Kind::Disc || kind_ == Kind::Rectangle || kind_ == Kind::Normal;
}

double Placement::heading_of(std::size_t index) {
    switch (heading_) {
    case Heading::Drawn:
        return kTurn * random_.uniform();
    case Heading::Fixed:
        return kind_ == Kind::List ? list_[index].heading + fixed_heading_ : fixed_heading_;
    case Heading::Spread:
        return parse_quantity(std::get<std::string>(drawn(heading_spread_, random_)->data), Dimension::Angle);
    default:
        break;
    }
    const double outward =
        start_ + kTurn * static_cast<double>(index) / static_cast<double>(std::max<std::size_t>(ring_, 1));
    return heading_ == Heading::Outward ? outward : outward + std::numbers::pi;
}

UnitPose Placement::draw() {
    UnitPose pose;
    switch (kind_) {
    case Kind::Disc: {
        const double distance = radius_ * std::sqrt(random_.uniform()), angle = kTurn * random_.uniform();
        pose.x = centre_.x + distance * std::cos(angle);
        pose.y = centre_.y + distance * std::sin(angle);
        break;
    }
    case Kind::Rectangle:
        pose.x = centre_.x + size_.x * (random_.uniform() - 0.5);
        pose.y = centre_.y + size_.y * (random_.uniform() - 0.5);
        break;
    case Kind::Normal:
        pose.x = centre_.x + size_.x * random_.normal();
        pose.y = centre_.y + size_.y * random_.normal();
        break;
    default: {  // the rectangle around the arena; what is outside is refused as an obstacle
        double left = 1e9, right = -1e9, bottom = 1e9, top = -1e9;
        for (const physics::Point& corner : arena_.corners) {
            left = std::min(left, corner.x);
            right = std::max(right, corner.x);
            bottom = std::min(bottom, corner.y);
            top = std::max(top, corner.y);
        }
        pose.x = left + (right - left) * random_.uniform();
        pose.y = bottom + (top - bottom) * random_.uniform();
    }
    }
    return pose;
}

UnitPose Placement::propose(std::size_t index) {
    UnitPose pose;
    if (is_drawn()) {
        pose = draw();
    } else if (kind_ == Kind::List) {
        pose = list_[index];
    } else if (kind_ == Kind::Ring) {
        const double angle = start_ + kTurn * static_cast<double>(index) /
                                          static_cast<double>(std::max<std::size_t>(ring_, 1));
        pose.x = centre_.x + radius_ * std::cos(angle);
        pose.y = centre_.y + radius_ * std::sin(angle);
    } else {
        const auto column = static_cast<double>(index % columns_),
                   row = static_cast<double>(index / columns_);
        pose.x = centre_.x + (static_cast<double>(columns_ - 1) / 2 - column) * size_.x;
        pose.y = centre_.y + (static_cast<double>(rows_ - 1) / 2 - row) * size_.y;
    }
    pose.heading = heading_of(index);
    if (is_drawn()) {
        pose.x = rounded(pose.x);
        pose.y = rounded(pose.y);
        pose.heading = rounded(pose.heading);
    }
    return pose;
}

Occupied::Occupied(const physics::World& world) : arena_(world.arena) {
    const auto shapes = fixed_shapes(world);
    const auto names = fixed_names(world);
    for (std::size_t i = 0; i < shapes.size(); ++i)
        add(shapes[i], names[i]);
    for (const auto& box : world.boxes)
        if (box.movable) add(shape_of(box), box.name);
    for (const auto& cylinder : world.cylinders)
        if (cylinder.movable) add(shape_of(cylinder), cylinder.name);
    for (const auto& robot : world.robots) {
        const auto& body = parameters_of(world, robot).robot;
        add(physics::circle_shape(robot.x, robot.y, body.radius, body.height, 1.0), robot.name);
    }
}

std::string Occupied::obstacle(const physics::Shape& shape, double gap) const {
    if (!physics::inside(arena_.corners, shape.x, shape.y)) return "it is outside the arena";
    physics::Shape wide = shape;
    wide.radius += gap;
    if (wide.kind == physics::Shape::Kind::Box) {
        wide.half_length += gap;
        wide.half_width += gap;
        wide.radius = std::hypot(wide.half_length, wide.half_width);
    }
    for (const Thing& thing : things_)
        if (physics::overlap(wide, thing.shape)) return fmt::format("{} is there", thing.name);
    return {};
}

}  // namespace puckloop::scenarios
