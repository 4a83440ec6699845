#pragma once
// The least-squares ellipse of points in the plane.

#include <optional>
#include <utility>
#include <vector>

namespace puckloop::tools {

struct Ellipse {
    double x = 0.0, y = 0.0;          ///< centre
    double major = 0.0, minor = 0.0;  ///< half axes, major >= minor
    double angle = 0.0;               ///< of the major axis from x, rad, -pi/2 < angle <= pi/2

    double area() const;
};

/// Direct least-squares fit of an ellipse (Fitzgibbon, Pilu and Fisher, IEEE PAMI 21, 1999; in the
/// numerically stable form of Halir and Flusser, WSCG 1998). Nothing for fewer than five points or where they
/// lie on a line.
std::optional<Ellipse> fit_ellipse(const std::vector<std::pair<double, double>>& points);

}  // namespace puckloop::tools
