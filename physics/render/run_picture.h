#pragma once
// The picture of one run, drawn from back to front. Only its own files include this.

#include "physics/render/path_file.h"
#include "physics/render/svg_canvas.h"
#include "physics/render/trail_file.h"
#include "physics/world/booth_record.h"

#include <array>
#include <string>
#include <vector>

namespace puckloop::physics {

struct Colour {
    int red, green, blue;
};

/// White outline that keeps a text readable on anything.
inline constexpr const char* kHalo =
    "paint-order=\"stroke\" stroke=\"#fff\" stroke-width=\"3\" stroke-linejoin=\"round\"";

/// 1, 2 or 5 times a power of ten, at least `least`.
double round_up(double least);

class Picture {
  public:
    Picture(const World& world, const Paths& robots, const Paths& objects,
            const std::vector<BoothColours>& booths, const std::vector<TrailSquare>& trails);
    /// The SVG document.
    std::string draw();

  private:
    // The scene (run_picture_scene.cpp).
    void floor();
    void grid();
    std::array<double, 4> bounds() const;
    void glow(const Lamp& lamp);
    void bulb(const Lamp& lamp);
    void label(double x, double y, const std::string& name, double right);
    void trails();
    void things();
    void virtual_things();
    void centred(const Shape& shape, const std::string& name);
    /// Where it stood, dashed; its way; where it ended.
    void moved(const std::string& name, Shape shape);

    // The TAMs (run_picture_booths.cpp).
    void booths();
    void booth(const Booth& booth, double end);

    // The robots (run_picture_robots.cpp).
    void path(const std::vector<PathPoint>& points, const Colour& colour);
    /// A dot and the time at round seconds; labels only where they do not crowd.
    void marks(const std::vector<PathPoint>& points, const Colour& colour);
    void robot(std::size_t index);
    void header();

    const World& world_;
    const Paths& robots_;
    const Paths& objects_;
    const std::vector<BoothColours>& booths_;
    const std::vector<TrailSquare>& trails_;
    SvgCanvas canvas_;
    std::vector<Pixel> labels_;
    std::size_t glows_ = 0;
};

}  // namespace puckloop::physics
