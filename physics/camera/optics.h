#pragma once
// Where a camera of the robot looks with each pixel: the omnidirectional one up into a hyperbolic mirror, the
// front one straight ahead through a pinhole. Both have a single point through which all rays go.
//
// The robot's frame: x ahead, y left, z up from the floor under the axle. A ray is its direction seen from
// above and its slope: metres down for each metre out.
//
// The mirror's law is the one of a perspective camera in the outer focus of a hyperboloid of two sheets
// (Yamazawa et al. 1993): with eccentricity e and elevation g of the ray at the camera, the elevation a of
// the ray at the inner focus has tan a = ((1 + e^2) sin g - 2 e) / ((1 - e^2) cos g). The camera's focal
// length is what makes the mirror's rim look up by the given angle. As ARGoS has it, ahead is to the left in
// the image and left is up.

#include "physics/description/parameters.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace puckloop::physics {

enum class CameraKind : std::uint8_t { Omni, Front };

struct ImageSize {
    std::uint32_t width = 640, height = 480;
    friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

struct ImagePoint {
    double u = 0.0, v = 0.0;  ///< pixels from the left and upper edges; the middle of the first is (0.5, 0.5)
};
/// A direction in the robot's frame: unit vector seen from above, and slope.
struct RayDirection {
    double x = 1.0, y = 0.0;
    double slope = 0.0;
};

class Optics {
  public:
    Optics(CameraKind kind, const CameraParameters& parameters, ImageSize size);

    CameraKind kind() const { return kind_; }
    ImageSize size() const { return size_; }
    /// Of the point through which all rays go, in the robot's frame.
    double x() const { return x_; }
    double z() const { return z_; }

    /// Nothing: the pixel sees no part of the mirror.
    std::optional<RayDirection> direction(ImagePoint point) const;
    /// Where a point is seen that lies `ahead`, `left` and `up` of the camera's point; nothing: behind it, or
    /// outside the mirror. The image may be too small for it.
    std::optional<ImagePoint> project(double ahead, double left, double up) const;

  private:
    double mirror_slope(double radius) const;
    double mirror_radius(double slope) const;

    CameraKind kind_;
    ImageSize size_;
    double x_ = 0.0, z_ = 0.0;
    double centre_u_, centre_v_, focal_ = 1.0;
    double eccentricity_ = 2.0, rim_ = 0.0;
};

/// The rays of all pixels, sorted by their direction seen from above: a column is all those that share one.
class PixelMap {
  public:
    explicit PixelMap(const Optics& optics);

    static constexpr std::uint16_t kNoColumn = 0xFFFF;
    struct Pixel {
        std::uint16_t column = kNoColumn;
        float slope = 0.0F;
    };
    struct Column {
        double x = 1.0, y = 0.0;  ///< unit vector, in the robot's frame
    };
    const std::vector<Pixel>& pixels() const { return pixels_; }  ///< rows from the top
    const std::vector<Column>& columns() const { return columns_; }

  private:
    std::vector<Pixel> pixels_;
    std::vector<Column> columns_;
};

}  // namespace puckloop::physics
