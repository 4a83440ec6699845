#include "physics/render/svg_canvas.h"

#include "base/pages/svg.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {
constexpr double kDrawing = 900;  // pixels of the longer side
constexpr double kMargin = 56;
constexpr double kHeader = 40;
}  // namespace

SvgCanvas::SvgCanvas(double left, double bottom, double right, double top)
    : left_(left),
      top_(top),
      scale_(kDrawing / std::max(right - left, top - bottom)),
      width_((right - left) * scale_ + 2 * kMargin),
      height_((top - bottom) * scale_ + 2 * kMargin + kHeader) {}

Pixel SvgCanvas::at(double x, double y) const {
    return {kMargin + (x - left_) * scale_, kMargin + kHeader + (top_ - y) * scale_};
}

void SvgCanvas::shape(const Shape& s, std::string_view style) {
    if (s.kind == Shape::Kind::Circle) {
        circle(s.x, s.y, pixels(s.radius), style);
        return;
    }
    std::vector<Point> corners;
    for (const auto& [u, v] : {std::pair{1, 1}, {-1, 1}, {-1, -1}, {1, -1}})
        corners.push_back({s.x + u * s.half_length * s.cosine - v * s.half_width * s.sine,
                           s.y + u * s.half_length * s.sine + v * s.half_width * s.cosine});
    polygon(corners, style);
}

void SvgCanvas::circle(double x, double y, double radius_pixels, std::string_view style) {
    const Pixel p = at(x, y);
    body_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:.1f}\" {}/>\n", p.x, p.y, radius_pixels,
                         style);
}

std::string SvgCanvas::points(const std::vector<Point>& points) const {
    std::string text;
    for (const Point& point : points) {
        const Pixel p = at(point.x, point.y);
        text += fmt::format("{}{:.1f},{:.1f}", text.empty() ? "" : " ", p.x, p.y);
    }
    return text;
}

void SvgCanvas::polygon(const std::vector<Point>& corners, std::string_view style) {
    body_ += fmt::format("<polygon points=\"{}\" {}/>\n", points(corners), style);
}

void SvgCanvas::polyline(const std::vector<Point>& list, std::string_view style) {
    body_ += fmt::format("<polyline points=\"{}\" {}/>\n", points(list), style);
}

void SvgCanvas::line(Pixel from, Pixel to, std::string_view style) {
    body_ += svg_line(from.x, from.y, to.x, to.y, style);
}

void SvgCanvas::text(Pixel where, std::string_view text, std::string_view style) {
    body_ += svg_text(where.x, where.y, text, style);
}

std::string SvgCanvas::document() const {
    return svg_document(width_, height_, 12, body_);
}

}  // namespace puckloop::physics
