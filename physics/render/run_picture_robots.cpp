// Paths, time marks, robots at start and end, the header; and the order of it all.

#include "physics/description/parameters.h"
#include "physics/render/run_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

/// Dark enough on white, apart for the colour-blind.
constexpr std::array<Colour, 8> kRobotColours{{{0, 90, 160},
                                               {200, 80, 0},
                                               {0, 130, 100},
                                               {150, 50, 130},
                                               {170, 120, 0},
                                               {190, 40, 60},
                                               {60, 130, 190},
                                               {90, 90, 90}}};
constexpr double kFirstTint = 0.35;  // of the colour at the start of a path
constexpr std::size_t kChunks = 48;  // pieces of a path, each darker than the last
constexpr double kMostMarks = 12;
constexpr double kMarkSpacing = 26;  // pixels between labels

std::string hex(const Colour& c, double tint = 1.0) {
    const auto part = [tint](int value) { return static_cast<int>(255 - tint * (255 - value)); };
    return fmt::format("#{:02x}{:02x}{:02x}", part(c.red), part(c.green), part(c.blue));
}

const Colour& colour_of(std::size_t robot) {
    return kRobotColours[robot % kRobotColours.size()];
}

}  // namespace

std::string Picture::draw() {
    floor();
    grid();
    for (const auto& wall : arena_walls(world_.arena))
        canvas_.shape(wall, "fill=\"#5b616b\"");
    for (const auto& lamp : world_.lamps)
        glow(lamp);
    booths();
    things();
    virtual_things();
    for (const auto& lamp : world_.lamps)
        bulb(lamp);
    for (std::size_t i = 0; i < robots_.size(); ++i)
        path(robots_[i].second, colour_of(i));
    for (std::size_t i = 0; i < robots_.size(); ++i)
        marks(robots_[i].second, colour_of(i));
    for (std::size_t i = 0; i < robots_.size(); ++i)
        robot(i);
    header();
    return canvas_.document();
}

void Picture::path(const std::vector<PathPoint>& points, const Colour& colour) {
    const std::size_t chunk = std::max<std::size_t>(1, (points.size() + kChunks - 1) / kChunks);
    for (std::size_t begin = 0; begin + 1 < points.size(); begin += chunk) {
        std::vector<Point> piece;
        for (std::size_t i = begin; i <= std::min(begin + chunk, points.size() - 1); ++i)
            piece.push_back({points[i].x, points[i].y});
        const double share = static_cast<double>(begin) / static_cast<double>(points.size());
        canvas_.polyline(piece, fmt::format("fill=\"none\" stroke=\"{}\" stroke-width=\"2.4\" "
                                            "stroke-linejoin=\"round\" stroke-linecap=\"round\"",
                                            hex(colour, kFirstTint + (1 - kFirstTint) * share)));
    }
}

void Picture::marks(const std::vector<PathPoint>& points, const Colour& colour) {
    if (points.size() < 2 || points.back().seconds <= 0) return;
    const double step = round_up(points.back().seconds / kMostMarks);
    double next = step;
    for (const auto& p : points) {
        if (p.seconds < next - 1e-9 || p.seconds > points.back().seconds - step / 4) continue;
        next += step;
        canvas_.circle(p.x, p.y, 3.2,
                       fmt::format("fill=\"#fff\" stroke=\"{}\" stroke-width=\"1.6\"", hex(colour)));
        const Pixel at = canvas_.at(p.x, p.y);
        const bool crowded = std::any_of(labels_.begin(), labels_.end(), [&](const Pixel& other) {
            return std::hypot(other.x - at.x, other.y - at.y) < kMarkSpacing;
        });
        if (crowded) continue;
        labels_.push_back(at);
        canvas_.text({at.x + 7, at.y - 6}, fmt::format("{:g} s", p.seconds),
                     fmt::format("font-size=\"11\" fill=\"{}\" {}", hex(colour), kHalo));
    }
}

void Picture::robot(std::size_t index) {
    const auto& [name, points] = robots_[index];
    if (points.empty()) return;
    Parameters parameters;
    for (const auto& [key, value] : world_.parameters)
        parameters.set(key, value);
    for (const auto& r : world_.robots)
        if (r.name == name)
            for (const auto& [key, value] : r.parameters)
                parameters.set(key, value);
    const auto& body = parameters.robot;
    const Colour& c = colour_of(index);
    const auto& first = points.front();
    const auto& last = points.back();
    canvas_.circle(first.x, first.y, canvas_.pixels(body.radius),
                   fmt::format("fill=\"{0}\" fill-opacity=\"0.25\" stroke=\"{0}\" stroke-width=\"1.2\" "
                               "stroke-dasharray=\"4 3\"",
                               hex(c)));
    canvas_.circle(last.x, last.y, canvas_.pixels(body.radius),
                   fmt::format("fill=\"{}\" stroke=\"{}\" stroke-width=\"2\"", hex(c, 0.3), hex(c)));
    const double cosine = std::cos(last.heading);
    const double sine = std::sin(last.heading);
    const auto point = [&](double forward, double left) {
        return Point{last.x + forward * cosine - left * sine, last.y + forward * sine + left * cosine};
    };
    for (const double side : {1.0, -1.0}) {
        constexpr double kTyre = 0.003;  // m, half its width
        const double out = side * body.axle_length / 2;
        const double r = body.wheel_radius_left;
        canvas_.polygon(
            {point(r, out - kTyre), point(r, out + kTyre), point(-r, out + kTyre), point(-r, out - kTyre)},
            "fill=\"#333\"");
    }
    const double r = body.radius;
    canvas_.polygon(
        {point(0.85 * r, 0), point(0.1 * r, 0.38 * r), point(0.28 * r, 0), point(0.1 * r, -0.38 * r)},
        fmt::format("fill=\"{}\"", hex(c)));
    const Pixel p = canvas_.at(last.x, last.y);
    canvas_.text({p.x, p.y - canvas_.pixels(r) - 6}, name,
                 fmt::format("text-anchor=\"middle\" font-weight=\"bold\" fill=\"{}\" {}", hex(c), kHalo));
}

void Picture::header() {
    double seconds = 0.0;
    for (const auto& [name, points] : robots_)
        if (!points.empty()) seconds = std::max(seconds, points.back().seconds);
    constexpr double kLeft = 56;
    canvas_.text({kLeft, 30}, fmt::format("{:g} s of simulated time", std::round(seconds * 10) / 10),
                 "font-size=\"16\" font-weight=\"bold\"");
    constexpr double kCharacter = 7.4, kMark = 22, kGap = 48;
    constexpr double kFirstRow = 46, kRow = 15, kLastRow = kFirstRow + kRow;
    double x = kLeft, y = kFirstRow;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
        const auto& [name, points] = robots_[i];
        double length = 0.0;
        for (std::size_t k = 1; k < points.size(); ++k)
            length += std::hypot(points[k].x - points[k - 1].x, points[k].y - points[k - 1].y);
        const std::string text = fmt::format("{}: {:.2f} m", name, length);
        const double wide = kGap + kCharacter * static_cast<double>(text.size());
        if (x + wide > canvas_.width() - kLeft && x > kLeft) {
            if (y >= kLastRow) {  // names stand beside the robots, too
                canvas_.text({x, y + 4}, "...", "");
                break;
            }
            x = kLeft;
            y += kRow;
        }
        canvas_.line(
            {x, y}, {x + kMark, y},
            fmt::format("stroke=\"{}\" stroke-width=\"3\" stroke-linecap=\"round\"", hex(colour_of(i))));
        canvas_.text({x + kMark + 6, y + 4}, text, "");
        x += wide;
    }
    canvas_.text({canvas_.width() - kLeft, 30}, "dashed: start · solid: end · paler: earlier",
                 "text-anchor=\"end\" fill=\"#777\" font-size=\"11\"");
}

}  // namespace puckloop::physics
