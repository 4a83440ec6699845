// Drawn from back to front: floor, patches, grid, walls, lamps, things, paths, marks, robots, texts.

#include "physics/trajectory_svg.h"

#include "base/error.h"
#include "physics/parameters.h"
#include "physics/path_file.h"
#include "physics/svg_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>

namespace puckloop::physics {

namespace {

struct Colour {
    int red, green, blue;
};
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
constexpr const char* kHalo =
    "paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"3\" stroke-linejoin=\"round\"";

std::string hex(const Colour& c, double tint = 1.0) {
    const auto part = [tint](int value) { return static_cast<int>(255 - tint * (255 - value)); };
    return fmt::format("#{:02x}{:02x}{:02x}", part(c.red), part(c.green), part(c.blue));
}

std::string grey(double value) {
    const int level = static_cast<int>(std::lround(40 + 213 * value));
    return fmt::format("#{0:02x}{0:02x}{0:02x}", level);
}

/// 1, 2 or 5 times a power of ten, at least `least`.
double round_up(double least) {
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= least * 0.999) return factor * power;
    return 10 * power;
}

class Picture {
  public:
    Picture(const World& world, const Paths& robots, const Paths& objects)
        : world_(world), robots_(robots), objects_(objects), canvas_(frame(world)) {}

    std::string draw() {
        floor();
        grid();
        for (const auto& wall : arena_walls(world_.arena))
            canvas_.shape(wall, "fill=\"#5b616b\"");
        for (const auto& lamp : world_.lamps)
            glow(lamp);
        things();
        for (const auto& lamp : world_.lamps)
            bulb(lamp);
        for (std::size_t i = 0; i < robots_.size(); ++i)
            path(robots_[i].second, colour(i));
        for (std::size_t i = 0; i < robots_.size(); ++i)
            marks(robots_[i].second, colour(i));
        for (std::size_t i = 0; i < robots_.size(); ++i)
            robot(i);
        header();
        return canvas_.document();
    }

  private:
    static SvgCanvas frame(const World& world) {
        double left = 1e9, bottom = 1e9, right = -1e9, top = -1e9;
        for (const auto& corner : world.arena.corners) {
            left = std::min(left, corner.x);
            right = std::max(right, corner.x);
            bottom = std::min(bottom, corner.y);
            top = std::max(top, corner.y);
        }
        const double border = world.arena.walls ? world.arena.wall_thickness : 0.0;
        return {left - border, bottom - border, right + border, top + border};
    }
    static const Colour& colour(std::size_t robot) { return kRobotColours[robot % kRobotColours.size()]; }

    void floor() {
        canvas_.raw("<clipPath id=\"arena\">");
        canvas_.polygon(world_.arena.corners, "");
        canvas_.raw("</clipPath>\n");
        canvas_.polygon(world_.arena.corners, fmt::format("fill=\"{}\" stroke=\"#999\" stroke-width=\"1\"",
                                                          grey(world_.arena.floor_grey)));
        canvas_.raw("<g clip-path=\"url(#arena)\">\n");
        for (const auto& p : world_.patches)
            canvas_.shape(p.shape == Patch::Shape::Disc
                              ? circle_shape(p.x, p.y, p.radius, 0, 0)
                              : box_shape(p.x, p.y, p.heading, p.length, p.width, 0, 0),
                          fmt::format("fill=\"{}\"", grey(p.grey)));
        canvas_.raw("</g>\n");
    }

    void grid() {
        const auto box = bounds();
        const double step = round_up(std::max(box[1] - box[0], box[3] - box[2]) / 12);
        const Pixel low = canvas_.at(box[0], box[2]);
        const Pixel high = canvas_.at(box[1], box[3]);
        const double border = canvas_.pixels(world_.arena.walls ? world_.arena.wall_thickness : 0.0);
        canvas_.raw("<g stroke=\"#8090a0\" stroke-opacity=\"0.22\" clip-path=\"url(#arena)\">\n");
        for (double x = std::ceil(box[0] / step - 1e-6) * step; x <= box[1] + 1e-9; x += step)
            canvas_.line({canvas_.at(x, 0).x, low.y}, {canvas_.at(x, 0).x, high.y}, "");
        for (double y = std::ceil(box[2] / step - 1e-6) * step; y <= box[3] + 1e-9; y += step)
            canvas_.line({low.x, canvas_.at(0, y).y}, {high.x, canvas_.at(0, y).y}, "");
        canvas_.raw("</g>\n<g fill=\"#777\" font-size=\"11\">\n");
        const auto label = [](double value) {
            return fmt::format("{:g}", std::round(value * 1e6) / 1e6 + 0.0);
        };
        for (double x = std::ceil(box[0] / step - 1e-6) * step; x <= box[1] + 1e-9; x += step)
            canvas_.text({canvas_.at(x, 0).x, low.y + border + 18}, label(x), "text-anchor=\"middle\"");
        for (double y = std::ceil(box[2] / step - 1e-6) * step; y <= box[3] + 1e-9; y += step)
            canvas_.text({low.x - border - 8, canvas_.at(0, y).y + 4}, label(y), "text-anchor=\"end\"");
        canvas_.text({(low.x + high.x) / 2, low.y + border + 38}, "metres", "text-anchor=\"middle\"");
        canvas_.raw("</g>\n");
    }

    std::array<double, 4> bounds() const {
        std::array<double, 4> box{1e9, -1e9, 1e9, -1e9};
        for (const auto& corner : world_.arena.corners) {
            box[0] = std::min(box[0], corner.x);
            box[1] = std::max(box[1], corner.x);
            box[2] = std::min(box[2], corner.y);
            box[3] = std::max(box[3], corner.y);
        }
        return box;
    }

    void glow(const Lamp& lamp) {
        const std::size_t serial = glows_++;
        canvas_.raw(fmt::format("<radialGradient id=\"glow{}\"><stop offset=\"0\" stop-color=\"#ffc928\" "
                                "stop-opacity=\"{:.2f}\"/><stop offset=\"1\" stop-color=\"#ffc928\" "
                                "stop-opacity=\"0\"/></radialGradient>\n",
                                serial, std::clamp(0.75 * lamp.intensity, 0.1, 0.9)));
        constexpr double kGlowRadius = 0.22;  // m, for the eye only
        canvas_.raw("<g clip-path=\"url(#arena)\">");
        canvas_.circle(lamp.x, lamp.y, canvas_.pixels(kGlowRadius),
                       fmt::format("fill=\"url(#glow{})\"", serial));
        canvas_.raw("</g>\n");
    }

    void bulb(const Lamp& lamp) {
        canvas_.circle(lamp.x, lamp.y, 6, "fill=\"#ffd84d\" stroke=\"#c98a00\" stroke-width=\"1.5\"");
        label(lamp.x, lamp.y, lamp.name, 12);
    }

    void label(double x, double y, const std::string& name, double right) {
        const Pixel p = canvas_.at(x, y);
        canvas_.text({p.x + right, p.y + 4}, name, fmt::format("font-size=\"11\" fill=\"#555\" {}", kHalo));
    }

    void things() {
        constexpr const char* kFixed = "fill=\"#c9b697\" stroke=\"#7d6a4b\" stroke-width=\"1.2\"";
        for (const auto& wall : world_.walls)
            canvas_.shape(shape_of(wall), "fill=\"#5b616b\"");
        const auto draw = [&](const auto& thing) {
            if (thing.movable)
                moved(thing.name, shape_of(thing));
            else
                canvas_.shape(shape_of(thing), kFixed);
            if (!thing.movable) centred(shape_of(thing), thing.name);
        };
        for (const auto& box : world_.boxes)
            draw(box);
        for (const auto& cylinder : world_.cylinders)
            draw(cylinder);
    }

    void centred(const Shape& shape, const std::string& name) {
        const Pixel p = canvas_.at(shape.x, shape.y);
        canvas_.text({p.x, p.y + 4}, name,
                     "text-anchor=\"middle\" font-size=\"11\" fill=\"#4d4029\" paint-order=\"stroke\" "
                     "stroke=\"#fff\" stroke-opacity=\"0.6\" stroke-width=\"3\"");
    }

    /// Where it stood, dashed; its way; where it ended.
    void moved(const std::string& name, Shape shape) {
        canvas_.shape(shape, "fill=\"none\" stroke=\"#4f7d57\" stroke-width=\"1\" stroke-dasharray=\"4 3\"");
        const auto way =
            std::find_if(objects_.begin(), objects_.end(), [&](const auto& p) { return p.first == name; });
        if (way != objects_.end()) {
            std::vector<Point> points;
            for (const auto& p : way->second)
                points.push_back({p.x, p.y});
            canvas_.polyline(points, "fill=\"none\" stroke=\"#4f7d57\" stroke-width=\"1.2\"");
            const auto& last = way->second.back();
            shape.place(last.x, last.y, last.heading);
        }
        canvas_.shape(shape, "fill=\"#bcd9bf\" stroke=\"#4f7d57\" stroke-width=\"1.2\"");
        centred(shape, name);
    }

    void path(const std::vector<PathPoint>& points, const Colour& colour) {
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

    /// A dot and the time at round seconds; labels only where they do not crowd.
    void marks(const std::vector<PathPoint>& points, const Colour& colour) {
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

    void robot(std::size_t index) {
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
        const Colour& c = colour(index);
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
            canvas_.polygon({point(r, out - kTyre), point(r, out + kTyre), point(-r, out + kTyre),
                             point(-r, out - kTyre)},
                            "fill=\"#333\"");
        }
        const double r = body.radius;
        canvas_.polygon(
            {point(0.85 * r, 0), point(0.1 * r, 0.38 * r), point(0.28 * r, 0), point(0.1 * r, -0.38 * r)},
            fmt::format("fill=\"{}\"", hex(c)));
        const Pixel p = canvas_.at(last.x, last.y);
        canvas_.text(
            {p.x, p.y - canvas_.pixels(r) - 6}, name,
            fmt::format("text-anchor=\"middle\" font-weight=\"bold\" fill=\"{}\" {}", hex(c), kHalo));
    }

    void header() {
        double seconds = 0.0;
        for (const auto& [name, points] : robots_)
            if (!points.empty()) seconds = std::max(seconds, points.back().seconds);
        constexpr double kLeft = 56;
        canvas_.text({kLeft, 30}, fmt::format("{:g} s of simulated time", std::round(seconds * 10) / 10),
                     "font-size=\"16\" font-weight=\"bold\"");
        double x = kLeft;
        for (std::size_t i = 0; i < robots_.size() && x < canvas_.width() - 200; ++i) {
            const auto& [name, points] = robots_[i];
            double length = 0.0;
            for (std::size_t k = 1; k < points.size(); ++k)
                length += std::hypot(points[k].x - points[k - 1].x, points[k].y - points[k - 1].y);
            canvas_.line(
                {x, 48}, {x + 22, 48},
                fmt::format("stroke=\"{}\" stroke-width=\"3\" stroke-linecap=\"round\"", hex(colour(i))));
            const std::string text = fmt::format("{}: {:.2f} m", name, length);
            canvas_.text({x + 28, 52}, text, "");
            constexpr double kCharacter = 7.4;
            x += 48 + kCharacter * static_cast<double>(text.size());
        }
        canvas_.text({canvas_.width() - kLeft, 30}, "dashed: start · solid: end · paler: earlier",
                     "text-anchor=\"end\" fill=\"#777\" font-size=\"11\"");
    }

    const World& world_;
    const Paths& robots_;
    const Paths& objects_;
    SvgCanvas canvas_;
    std::vector<Pixel> labels_;
    std::size_t glows_ = 0;
};

}  // namespace

void write_trajectory_svg(const World& world, const std::filesystem::path& directory) {
    const Paths robots = read_paths(directory / "trajectory.csv");
    const auto objects_file = directory / "objects.csv";
    const Paths objects = std::filesystem::exists(objects_file) ? read_paths(objects_file) : Paths{};
    const std::string document = Picture(world, robots, objects).draw();
    const auto file = directory / "trajectory.svg";
    std::FILE* out = std::fopen(file.c_str(), "w");
    const bool written = out != nullptr && std::fputs(document.c_str(), out) >= 0;
    const bool closed = out != nullptr && std::fclose(out) == 0;
    if (!written || !closed) throw RunError(fmt::format("cannot write {}", file.string()));
}

}  // namespace puckloop::physics
