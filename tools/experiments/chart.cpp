#include "tools/experiments/chart.h"

#include "physics/render/svg_canvas.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::tools {

namespace {

using physics::escaped;

// Layout in pixels.
constexpr double kWide = 720, kHigh = 330, kSquare = 460;
constexpr double kLeft = 64, kTop = 72, kRight = 24, kBottom = 56;
constexpr const char* kGrid = "#e2e2e2";

int ticks(const Axis& axis) {
    return static_cast<int>(std::floor((axis.high - axis.low) / axis.step + 1e-9));
}

}  // namespace

Chart::Chart(const std::string& title, const std::string& caption, Axis x, Axis y, bool square)
    : x_(std::move(x)),
      y_(std::move(y)),
      width_(square ? kSquare : kWide),
      height_(square ? kSquare : kHigh) {
    svg_ = fmt::format("<text x=\"{0:g}\" y=\"26\" font-size=\"17\" font-weight=\"bold\">{1}</text>\n"
                       "<text x=\"{0:g}\" y=\"46\" fill=\"#555\">{2}</text>\n",
                       kLeft, escaped(title), escaped(caption));
    for (int i = 0; i <= ticks(x_); ++i) {
        const double value = x_.low + i * x_.step, at = px(value);
        svg_ += fmt::format("<line x1=\"{0:.1f}\" x2=\"{0:.1f}\" y1=\"{1:g}\" y2=\"{2:g}\" stroke=\"{3}\"/>"
                            "<text x=\"{0:.1f}\" y=\"{4:g}\" text-anchor=\"middle\">{5:g}</text>\n",
                            at, kTop, kTop + height_, kGrid, kTop + height_ + 18, value);
    }
    for (int i = 0; i <= ticks(y_); ++i) {
        const double value = y_.low + i * y_.step, at = py(value);
        svg_ += fmt::format("<line x1=\"{1:g}\" x2=\"{2:g}\" y1=\"{0:.1f}\" y2=\"{0:.1f}\" stroke=\"{3}\"/>"
                            "<text x=\"{4:g}\" y=\"{5:.1f}\" text-anchor=\"end\">{6:g}</text>\n",
                            at, kLeft, kLeft + width_, kGrid, kLeft - 7, at + 4, value);
    }
    svg_ += fmt::format(
        "<text x=\"{0:g}\" y=\"{1:g}\" text-anchor=\"middle\">{2}</text>\n"
        "<text x=\"16\" y=\"{3:g}\" text-anchor=\"middle\" transform=\"rotate(-90 16 {3:g})\">"
        "{4}</text>\n",
        kLeft + width_ / 2, kTop + height_ + 42, escaped(x_.title), kTop + height_ / 2, escaped(y_.title));
}

double Chart::px(double x) const {
    return kLeft + width_ * (std::clamp(x, x_.low, x_.high) - x_.low) / (x_.high - x_.low);
}

double Chart::py(double y) const {
    return kTop + height_ * (y_.high - std::clamp(y, y_.low, y_.high)) / (y_.high - y_.low);
}

std::string Chart::joined(const Points& points) const {
    std::string text;
    for (const auto& [x, y] : points)
        text += fmt::format("{:.1f},{:.1f} ", px(x), py(y));
    return text;
}

void Chart::line(const Points& points, std::string_view colour, std::string_view style) {
    svg_ += fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.6\" {}/>\n",
                        joined(points), colour, style);
}

void Chart::band(const Points& low, const Points& high, std::string_view colour) {
    svg_ += fmt::format("<polygon points=\"{}{}\" fill=\"{}\" fill-opacity=\"0.18\"/>\n", joined(low),
                        joined(Points(high.rbegin(), high.rend())), colour);
}

void Chart::dots(const Points& points, std::string_view colour, double radius) {
    for (const auto& [x, y] : points)
        svg_ += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"{:g}\" fill=\"{}\"/>\n", px(x), py(y),
                            radius, colour);
}

void Chart::level(double y, const std::string& name) {
    svg_ += fmt::format("<line x1=\"{0:g}\" x2=\"{1:g}\" y1=\"{2:.1f}\" y2=\"{2:.1f}\" stroke=\"#c2541b\" "
                        "stroke-dasharray=\"5 4\"/><text x=\"{3:g}\" y=\"{4:.1f}\" text-anchor=\"end\" "
                        "fill=\"#c2541b\">{5}</text>\n",
                        kLeft, kLeft + width_, py(y), kLeft + width_ - 4, py(y) - 5, escaped(name));
}

void Chart::text(double x, double y, const std::string& words, std::string_view style) {
    svg_ +=
        fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" {}>{}</text>\n", px(x), py(y), style, escaped(words));
}

std::string Chart::document() const {
    return fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:g} {1:g}\" width=\"{0:g}\" "
        "height=\"{1:g}\" font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n{2}</svg>\n",
        kLeft + width_ + kRight, kTop + height_ + kBottom, svg_);
}

}  // namespace puckloop::tools
