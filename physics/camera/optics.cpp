#include "physics/camera/optics.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr double kSensorColumns = 640.0;  // of the sensor, over whose width the front camera's view is given
constexpr double kSensorRows = 480.0;
/// Columns around the mirror: less than half a pixel apart at the rim of the largest image.
constexpr std::size_t kMirrorColumns = 2048;

/// tan of the elevation at the mirror's focus, of a ray that leaves the camera with elevation g.
double mirror_law(double e, double g) {
    return ((1 + e * e) * std::sin(g) - 2 * e) / ((1 - e * e) * std::cos(g));
}

/// The elevation at the camera of the ray whose elevation at the mirror's focus has the tangent `t`:
/// (1 + e^2) sin g - t (1 - e^2) cos g = 2 e, of whose two solutions the mirror's is the lesser.
double camera_elevation(double e, double t) {
    const double s = 1 + e * e;
    const double c = -t * (1 - e * e);
    return std::asin(std::min(1.0, 2 * e / std::hypot(s, c))) - std::atan2(c, s);
}

}  // namespace

Optics::Optics(CameraKind kind, const CameraParameters& p, ImageSize size)
    : kind_(kind), size_(size), centre_u_(size.width / 2.0), centre_v_(size.height / 2.0) {
    if (kind == CameraKind::Omni) {
        z_ = p.height;
        centre_u_ += p.centre_x * size.height;
        centre_v_ += p.centre_y * size.height;
        rim_ = p.rim * size.height;
        eccentricity_ = p.eccentricity;
        focal_ = rim_ * std::tan(camera_elevation(eccentricity_, std::tan(p.rim_elevation)));
    } else {
        x_ = p.front_x;
        z_ = p.front_height;
        focal_ = kSensorColumns / 2 / std::tan(p.front_fov / 2) * size.height / kSensorRows;
    }
}

double Optics::mirror_slope(double radius) const {
    return -mirror_law(eccentricity_, std::atan2(focal_, radius));
}
double Optics::mirror_radius(double slope) const {
    return focal_ / std::tan(camera_elevation(eccentricity_, -slope));
}

std::optional<RayDirection> Optics::direction(ImagePoint point) const {
    const double du = point.u - centre_u_;
    const double dv = point.v - centre_v_;
    const double radius = std::hypot(du, dv);
    if (kind_ == CameraKind::Omni) {
        if (radius >= rim_) return std::nullopt;
        if (radius < 1e-9) return RayDirection{1.0, 0.0, mirror_slope(1e-9)};
        return RayDirection{-du / radius, -dv / radius, mirror_slope(radius)};
    }
    const double length = std::hypot(focal_, du);
    return RayDirection{focal_ / length, -du / length, dv / length};
}

std::optional<ImagePoint> Optics::project(double ahead, double left, double up) const {
    if (kind_ == CameraKind::Front) {
        if (ahead <= 1e-6) return std::nullopt;
        return ImagePoint{centre_u_ - focal_ * left / ahead, centre_v_ - focal_ * up / ahead};
    }
    const double distance = std::hypot(ahead, left);
    if (distance < 1e-9) return std::nullopt;
    const double radius = mirror_radius(-up / distance);
    if (radius >= rim_ || radius < 0.0) return std::nullopt;
    return ImagePoint{centre_u_ - radius * ahead / distance, centre_v_ - radius * left / distance};
}

PixelMap::PixelMap(const Optics& optics) {
    const ImageSize size = optics.size();
    pixels_.resize(std::size_t{size.width} * size.height);
    const bool mirror = optics.kind() == CameraKind::Omni;
    columns_.resize(mirror ? kMirrorColumns : size.width);
    constexpr double kTurn = 2 * std::numbers::pi;
    for (std::size_t i = 0; mirror && i < columns_.size(); ++i) {
        const double angle = kTurn * static_cast<double>(i) / kMirrorColumns;
        columns_[i] = {std::cos(angle), std::sin(angle)};
    }
    for (std::uint32_t row = 0; row < size.height; ++row) {
        for (std::uint32_t u = 0; u < size.width; ++u) {
            const auto ray = optics.direction({u + 0.5, row + 0.5});
            if (!ray) continue;
            Pixel& pixel = pixels_[std::size_t{row} * size.width + u];
            pixel.slope = static_cast<float>(ray->slope);
            if (!mirror) {
                columns_[u] = {ray->x, ray->y};
                pixel.column = static_cast<std::uint16_t>(u);
                continue;
            }
            const double part = std::atan2(ray->y, ray->x) / kTurn;
            const auto nearest = static_cast<long>(std::lround(part * kMirrorColumns));
            pixel.column = static_cast<std::uint16_t>((nearest + 2 * static_cast<long>(kMirrorColumns)) %
                                                      static_cast<long>(kMirrorColumns));
        }
    }
}

}  // namespace puckloop::physics
