// Floor, patches, grid, lamps, things.

#include "physics/render/run_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

std::string grey(double value) {
    const int level = static_cast<int>(std::lround(40 + 213 * value));
    return fmt::format("#{0:02x}{0:02x}{0:02x}", level);
}

SvgCanvas frame(const World& world) {
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

}  // namespace

/// 1, 2 or 5 times a power of ten, at least `least`.
double round_up(double least) {
    const double power = std::pow(10.0, std::floor(std::log10(least)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (factor * power >= least * 0.999) return factor * power;
    return 10 * power;
}

namespace {

/// As rectangles of one colour, in at most kCells rows and columns.
void draw_image(const Patch& patch, SvgCanvas& canvas) {
    constexpr std::size_t kCells = 120;
    const std::size_t columns = std::min(patch.image.width(), kCells);
    const std::size_t rows = std::min(patch.image.height(), kCells);
    const double length = patch.length / static_cast<double>(columns);
    const double width = patch.width / static_cast<double>(rows);
    const double cosine = std::cos(patch.heading), sine = std::sin(patch.heading);
    constexpr double kSeam = 1.02;  // so that nothing shows between neighbours
    for (std::size_t row = 0; row < rows; ++row) {
        const auto colour = [&](std::size_t column) {
            return patch.image.at((static_cast<double>(column) + 0.5) / static_cast<double>(columns),
                                  (static_cast<double>(row) + 0.5) / static_cast<double>(rows));
        };
        for (std::size_t from = 0, to = 0; from < columns; from = to) {
            const Rgb now = colour(from);
            for (to = from + 1; to < columns && colour(to) == now;)
                ++to;
            const double along = length * static_cast<double>(from + to) / 2 - patch.length / 2;
            const double up = width * (static_cast<double>(row) + 0.5) - patch.width / 2;
            canvas.shape(box_shape(patch.x + cosine * along - sine * up, patch.y + sine * along + cosine * up,
                                   patch.heading, length * static_cast<double>(to - from) * kSeam,
                                   width * kSeam, 0, 0),
                         fmt::format("fill=\"#{:02x}{:02x}{:02x}\"", now[0], now[1], now[2]));
        }
    }
}

}  // namespace

Picture::Picture(const World& world, const Paths& robots, const Paths& objects,
                 const std::vector<BoothColours>& booths, const std::vector<TrailSquare>& trails)
    : world_(world),
      robots_(robots),
      objects_(objects),
      booths_(booths),
      trails_(trails),
      canvas_(frame(world)) {}

void Picture::floor() {
    canvas_.raw("<clipPath id=\"arena\">");
    canvas_.polygon(world_.arena.corners, "");
    canvas_.raw("</clipPath>\n");
    canvas_.polygon(world_.arena.corners, fmt::format("fill=\"{}\" stroke=\"#999\" stroke-width=\"1\"",
                                                      grey(world_.arena.floor_grey)));
    canvas_.raw("<g clip-path=\"url(#arena)\">\n");
    for (const auto& p : world_.patches)
        if (!p.image.empty())
            draw_image(p, canvas_);
        else
            canvas_.shape(p.shape == Patch::Shape::Disc
                              ? circle_shape(p.x, p.y, p.radius, 0, 0)
                              : box_shape(p.x, p.y, p.heading, p.length, p.width, 0, 0),
                          fmt::format("fill=\"{}\"", grey(p.grey)));
    trails();
    canvas_.raw("</g>\n");
}

/// As at the end of the run. Squares beside each other that look the same are one shape.
void Picture::trails() {
    constexpr double kLevels = 16;
    const auto level = [](const TrailSquare& square) { return std::lround(square.strength * kLevels); };
    for (std::size_t from = 0, to = 0; from < trails_.size(); from = to) {
        const TrailSquare& first = trails_[from];
        const auto goes_on = [&](const TrailSquare& next) {
            const double expected = first.x + static_cast<double>(to - from) * first.side;
            return next.grey == first.grey && level(next) == level(first) &&
                   std::abs(next.y - first.y) < first.side / 2 &&
                   std::abs(next.x - expected) < first.side / 2;
        };
        for (to = from + 1; to < trails_.size() && goes_on(trails_[to]);)
            ++to;
        if (level(first) == 0) continue;
        const double length = static_cast<double>(to - from) * first.side;
        canvas_.shape(box_shape(first.x + (length - first.side) / 2, first.y, 0, length, first.side, 0, 0),
                      fmt::format("fill=\"{}\" fill-opacity=\"{:.2f}\"", grey(first.grey),
                                  static_cast<double>(level(first)) / kLevels));
    }
}

void Picture::grid() {
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
    const auto label = [](double value) { return fmt::format("{:g}", std::round(value * 1e6) / 1e6 + 0.0); };
    for (double x = std::ceil(box[0] / step - 1e-6) * step; x <= box[1] + 1e-9; x += step)
        canvas_.text({canvas_.at(x, 0).x, low.y + border + 18}, label(x), "text-anchor=\"middle\"");
    for (double y = std::ceil(box[2] / step - 1e-6) * step; y <= box[3] + 1e-9; y += step)
        canvas_.text({low.x - border - 8, canvas_.at(0, y).y + 4}, label(y), "text-anchor=\"end\"");
    canvas_.text({(low.x + high.x) / 2, low.y + border + 38}, "metres", "text-anchor=\"middle\"");
    canvas_.raw("</g>\n");
}

std::array<double, 4> Picture::bounds() const {
    std::array<double, 4> box{1e9, -1e9, 1e9, -1e9};
    for (const auto& corner : world_.arena.corners) {
        box[0] = std::min(box[0], corner.x);
        box[1] = std::max(box[1], corner.x);
        box[2] = std::min(box[2], corner.y);
        box[3] = std::max(box[3], corner.y);
    }
    return box;
}

void Picture::glow(const Lamp& lamp) {
    const std::size_t serial = glows_++;
    canvas_.raw(fmt::format("<radialGradient id=\"glow{}\"><stop offset=\"0\" stop-color=\"#ffc928\" "
                            "stop-opacity=\"{:.2f}\"/><stop offset=\"1\" stop-color=\"#ffc928\" "
                            "stop-opacity=\"0\"/></radialGradient>\n",
                            serial, std::clamp(0.75 * lamp.intensity, 0.1, 0.9)));
    constexpr double kGlowRadius = 0.22;  // m, for the eye only
    canvas_.raw("<g clip-path=\"url(#arena)\">");
    canvas_.circle(lamp.x, lamp.y, canvas_.pixels(kGlowRadius), fmt::format("fill=\"url(#glow{})\"", serial));
    canvas_.raw("</g>\n");
}

void Picture::bulb(const Lamp& lamp) {
    canvas_.circle(lamp.x, lamp.y, 6, "fill=\"#ffd84d\" stroke=\"#c98a00\" stroke-width=\"1.5\"");
    label(lamp.x, lamp.y, lamp.name, 12);
}

void Picture::label(double x, double y, const std::string& name, double right) {
    const Pixel p = canvas_.at(x, y);
    canvas_.text({p.x + right, p.y + 4}, name, fmt::format("font-size=\"11\" fill=\"#555\" {}", kHalo));
}

void Picture::things() {
    constexpr const char* kFixed = "fill=\"#c9b697\" stroke=\"#7d6a4b\" stroke-width=\"1.2\"";
    for (const auto& wall : world_.walls)
        canvas_.shape(shape_of(wall), "fill=\"#5b616b\"");
    const auto draw = [&](const auto& thing) {
        const bool by_hand = std::any_of(objects_.begin(), objects_.end(),
                                         [&](const auto& path) { return path.first == thing.name; });
        if (thing.movable || by_hand) {
            moved(thing.name, shape_of(thing));
            return;
        }
        canvas_.shape(shape_of(thing), kFixed);
        centred(shape_of(thing), thing.name);
    };
    for (const auto& box : world_.boxes)
        draw(box);
    for (const auto& cylinder : world_.cylinders)
        draw(cylinder);
}

/// Dashed: only robots sense them.
void Picture::virtual_things() {
    constexpr const char* kDashed =
        "fill=\"#963282\" fill-opacity=\"0.12\" stroke=\"#963282\" stroke-width=\"1.2\" "
        "stroke-dasharray=\"3 3\"";
    for (const VirtualBody& body : virtual_bodies(world_.virtuals)) {
        Shape shape = body.shape;
        const auto way = std::find_if(objects_.begin(), objects_.end(),
                                      [&](const auto& path) { return path.first == body.name; });
        if (way != objects_.end()) {
            const auto& last = way->second.back();
            shape.place(last.x, last.y, last.heading);
        }
        canvas_.shape(shape, kDashed);
        centred(shape, body.name);
    }
    for (const auto& lamp : world_.virtuals.lamps) {
        canvas_.circle(lamp.x, lamp.y, 7, kDashed);
        label(lamp.x, lamp.y, lamp.name, 12);
    }
}

void Picture::centred(const Shape& shape, const std::string& name) {
    const Pixel p = canvas_.at(shape.x, shape.y);
    canvas_.text({p.x, p.y + 4}, name,
                 "text-anchor=\"middle\" font-size=\"11\" fill=\"#4d4029\" paint-order=\"stroke\" "
                 "stroke=\"#fff\" stroke-opacity=\"0.6\" stroke-width=\"3\"");
}

void Picture::moved(const std::string& name, Shape shape) {
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

}  // namespace puckloop::physics
