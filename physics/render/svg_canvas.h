#pragma once
// SVG text with the world's coordinates: metres in, pixels out, y up.

#include "physics/description/plan.h"

#include <string>
#include <string_view>
#include <vector>

namespace puckloop::physics {

struct Pixel {
    double x = 0.0, y = 0.0;
};

class SvgCanvas {
  public:
    /// The world's part from (left, bottom) to (right, top) in metres, scaled to fit, with margins.
    SvgCanvas(double left, double bottom, double right, double top);

    Pixel at(double x, double y) const;
    double pixels(double metres) const { return metres * scale_; }
    double width() const { return width_; }
    double height() const { return height_; }

    /// `style`: SVG attributes, as they are.
    void shape(const Shape& shape, std::string_view style);
    void circle(double x, double y, double radius_pixels, std::string_view style);
    void polygon(const std::vector<Point>& corners, std::string_view style);
    void polyline(const std::vector<Point>& points, std::string_view style);
    void line(Pixel from, Pixel to, std::string_view style);
    void text(Pixel where, std::string_view text, std::string_view style);
    void raw(std::string_view svg) { body_ += svg; }

    /// The whole document.
    std::string document() const;

  private:
    std::string points(const std::vector<Point>& points) const;

    double left_, top_, scale_, width_, height_;
    std::string body_;
};

}  // namespace puckloop::physics
