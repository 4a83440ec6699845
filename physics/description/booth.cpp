#include "physics/description/booth.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace puckloop::physics {

namespace {

using Interval = std::pair<double, double>;

constexpr double kHalf = booth::kSize / 2;
constexpr double kHalfGap = kHalf - booth::kShell;  // the beams go from shell to shell

/// Where along x a circle is between the shells.
std::optional<Interval> shadow_of_circle(double x, double y, double radius) {
    const double outside = std::max(std::abs(y) - kHalfGap, 0.0);
    if (outside >= radius) return std::nullopt;
    const double half = std::sqrt(radius * radius - outside * outside);
    return Interval{x - half, x + half};
}

/// The same for a convex polygon: what is left of its edges between the shells.
std::optional<Interval> shadow_of_polygon(std::span<const Point> corners) {
    Interval shadow{1e9, -1e9};
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Point a = corners[i], b = corners[(i + 1) % corners.size()];
        double from = 0.0, to = 1.0;
        const double rise = b.y - a.y;
        if (std::abs(rise) < 1e-12) {
            if (std::abs(a.y) > kHalfGap) continue;
        } else {
            const double low = (-kHalfGap - a.y) / rise, high = (kHalfGap - a.y) / rise;
            from = std::max(from, std::min(low, high));
            to = std::min(to, std::max(low, high));
            if (from > to) continue;
        }
        for (const double t : {from, to}) {
            const double x = a.x + t * (b.x - a.x);
            shadow.first = std::min(shadow.first, x);
            shadow.second = std::max(shadow.second, x);
        }
    }
    if (shadow.first > shadow.second) return std::nullopt;
    return shadow;
}

/// Share of the beam around `middle` that the shadows cover together; sorts them.
double covered(std::vector<Interval>& shadows, double middle) {
    const double first = middle - booth::kBeamWidth / 2, last = middle + booth::kBeamWidth / 2;
    std::sort(shadows.begin(), shadows.end());
    double sum = 0.0, reached = first;
    for (const auto& [from, to] : shadows) {
        const double begin = std::clamp(from, reached, last), end = std::clamp(to, begin, last);
        sum += end - begin;
        reached = std::max(reached, end);
    }
    return std::clamp(sum / booth::kBeamWidth, 0.0, 1.0);
}

}  // namespace

bool is_booth(const World& world, std::string_view name) {
    return std::any_of(world.booths.begin(), world.booths.end(),
                       [&](const Booth& booth) { return booth.name == name; });
}

Point from_booth(const Booth& booth, double x, double y) {
    const double cosine = std::cos(booth.heading), sine = std::sin(booth.heading);
    return {booth.x + cosine * x - sine * y, booth.y + sine * x + cosine * y};
}

std::vector<Shape> shapes_of(const Booth& b) {
    const auto part = [&](double x0, double x1, double y0, double y1, double height) {
        const Point middle = from_booth(b, (x0 + x1) / 2, (y0 + y1) / 2);
        return box_shape(middle.x, middle.y, b.heading, x1 - x0, y1 - y0, height, b.reflectivity);
    };
    const double inside = kHalf - booth::kShell;
    const double strip = inside - booth::kBumper;
    const double strip_end = kHalf - booth::kBumperLength;
    return {part(-kHalf, kHalf, inside, kHalf, booth::kSize),
            part(-kHalf, kHalf, -kHalf, -inside, booth::kSize),
            part(-kHalf, booth::kBack, -inside, inside, booth::kSize),
            part(strip_end, kHalf, strip, inside, booth::kBumperHeight),
            part(strip_end, kHalf, -inside, -strip, booth::kBumperHeight)};
}

std::vector<std::string> part_names(const Booth& b) {
    return {b.name + " left side", b.name + " right side", b.name + " back", b.name + " left bumper",
            b.name + " right bumper"};
}

BoothModel::BoothModel(const Booth& b) : booth_(b), cosine_(std::cos(b.heading)), sine_(std::sin(b.heading)) {
    for (std::size_t i = 0; i < booth::kLights; ++i) {
        const booth::LampPlace& place = booth::kLight[i];
        const Point at = from_booth(b, place.x, place.y);
        lights_[i] = {.x = at.x, .y = at.y, .z = place.z, .radius = place.radius};
    }
}

bool BoothModel::near(const Shape& body) const {
    const double dx = body.x - booth_.x, dy = body.y - booth_.y;
    constexpr double kReach = booth::kSize * 0.75;  // more than half the diagonal
    const double reach = kReach + body.radius;
    return dx * dx + dy * dy < reach * reach && body.height > booth::kBeamHeight;
}

std::array<double, booth::kBarriers> BoothModel::interrupted(std::span<const Shape* const> bodies) const {
    std::vector<Interval> shadows;
    for (const Shape* body : bodies) {
        if (!near(*body)) continue;
        const double dx = body->x - booth_.x, dy = body->y - booth_.y;
        const Point middle{cosine_ * dx + sine_ * dy, -sine_ * dx + cosine_ * dy};
        std::optional<Interval> shadow;
        if (body->kind == Shape::Kind::Circle) {
            shadow = shadow_of_circle(middle.x, middle.y, body->radius);
        } else {
            // The box's own axes in the booth's frame.
            const double c = cosine_ * body->cosine + sine_ * body->sine;
            const double s = cosine_ * body->sine - sine_ * body->cosine;
            std::array<Point, 4> corners;
            constexpr std::array<std::array<double, 2>, 4> kCorner{{{1, 1}, {-1, 1}, {-1, -1}, {1, -1}}};
            for (std::size_t i = 0; i < corners.size(); ++i) {
                const double along = kCorner[i][0] * body->half_length,
                             across = kCorner[i][1] * body->half_width;
                corners[i] = {middle.x + c * along - s * across, middle.y + s * along + c * across};
            }
            shadow = shadow_of_polygon(corners);
        }
        if (shadow) shadows.push_back(*shadow);
    }
    std::array<double, booth::kBarriers> shares{};
    if (shadows.empty()) return shares;
    for (std::size_t i = 0; i < shares.size(); ++i)
        shares[i] = covered(shadows, booth::kBeam[i]);
    return shares;
}

void BoothModel::shine(std::size_t index, std::size_t colour, double duty) {
    ColouredLight& light = lights_[index];
    (colour == 0 ? light.red : colour == 1 ? light.green : light.blue) = std::clamp(duty, 0.0, 1.0);
}

void BoothModel::dark() {
    for (ColouredLight& light : lights_)
        light.red = light.green = light.blue = 0.0;
}

}  // namespace puckloop::physics
