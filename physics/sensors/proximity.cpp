#include "physics/sensors/proximity.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kProximityFullScale = 4095;
constexpr double kExponentReference = 0.03;  // m: where proximity.extra_exponent changes nothing
constexpr double kExponentOrigin = 0.0099;   // m: effective origin of the measured table [M]
constexpr double kBatteryReference = 3.7;    // V: where proximity.battery_gain changes nothing

struct CurvePoint {
    double millimetres, counts;
};
/// Measured on a real robot [W] to 70 mm; beyond: about 20 counts at 100 mm [M], nothing at 120 mm [E].
constexpr CurvePoint kMeasured[] = {{0, 4095},    {5, 2133.33}, {10, 1465.73}, {15, 601.46},
                                    {20, 383.84}, {30, 234.93}, {40, 158.03},  {50, 120.00},
                                    {60, 104.09}, {70, 67.19},  {100, 20},     {120, 0}};

double table_response(double millimetres) {
    const auto* const after =
        std::upper_bound(std::begin(kMeasured), std::end(kMeasured), millimetres,
                         [](double value, const CurvePoint& point) { return value < point.millimetres; });
    if (after == std::end(kMeasured)) return 0.0;
    const auto& a = *(after - 1);
    const auto& b = *after;
    return a.counts + (b.counts - a.counts) * (millimetres - a.millimetres) / (b.millimetres - a.millimetres);
}

double compressed(double counts, double saturation) {
    return counts <= 0.0 ? 0.0 : 1.0 / (1.0 / saturation + 1.0 / counts);
}

/// std::pow() without the work where it changes nothing.
double power(double base, double exponent) {
    return exponent == 1.0 ? base : std::pow(base, exponent);
}

double curve_at(const ProximityParameters& p, double distance) {
    switch (std::lround(p.curve)) {
    case 1:
        return compressed(p.amplitude / std::pow((distance + p.origin) * 1e3, p.exponent), p.saturation);
    case 2:
        return compressed(p.amplitude * std::exp(-distance / std::max(p.origin, 1e-6)), p.saturation);
    default:
        return table_response(distance * 1e3);
    }
}
}  // namespace

double proximity_response(const ProximityParameters& p, double distance) {
    if (distance > p.reach) return 0.0;
    distance = std::max(distance, 0.0);
    double counts = curve_at(p, distance);
    if (p.extra_exponent != 0.0)
        counts *= std::pow((distance + kExponentOrigin) / (kExponentReference + kExponentOrigin),
                           -p.extra_exponent);
    if (p.compression != 0.0) counts /= 1.0 + p.compression * counts;
    return counts;
}

ProximityRing::ProximityRing(const ProximityParameters& parameters) : parameters_(parameters) {
    const auto count = std::lround(parameters.rays);
    for (std::size_t i = 0; i < kProximitySensors; ++i) {
        horizon_ = std::max(horizon_, std::hypot(parameters.x[i], parameters.y[i]) + parameters.reach);
        for (long k = 0; k < count; ++k) {
            const double share =
                count == 1 ? 0.0 : static_cast<double>(k) / static_cast<double>(count - 1) - 0.5;
            const double angle = parameters.direction[i] + share * parameters.aperture;
            rays_[i].push_back({parameters.x[i], parameters.y[i], std::cos(angle), std::sin(angle)});
        }
    }
}

double ProximityRing::seen_by(const SensorView& view, std::size_t sensor, double cosine, double sine) const {
    double sum = 0.0;
    for (const Ray& own : rays_[sensor]) {
        const Ray ray = in_world(view.robot, cosine, sine, own);
        double nearest = parameters_.reach;
        double incidence = 0.0;
        const Shape* seen = nullptr;
        for (const Shape* shape : view.shapes) {
            const auto hit = chord_before(*shape, ray.x, ray.y, ray.dx, ray.dy, nearest);
            if (!hit) continue;
            nearest = std::max(hit->in, 0.0);
            incidence = hit->cosine;
            seen = shape;
        }
        if (seen == nullptr) continue;
        const double brightness = seen->reflectivity * power(incidence, parameters_.incidence_exponent);
        if (brightness > 0.0)
            sum += brightness * proximity_response(parameters_, nearest + parameters_.distance_shift);
    }
    return sum / static_cast<double>(rays_[sensor].size());
}

std::array<double, kProximitySensors> ProximityRing::reflected(const SensorView& view) const {
    std::array<double, kProximitySensors> own{};
    if (view.shapes.empty()) return own;
    const double cosine = std::cos(view.robot.heading);
    const double sine = std::sin(view.robot.heading);
    for (std::size_t i = 0; i < kProximitySensors; ++i)
        own[i] = seen_by(view, i, cosine, sine);
    return own;
}

std::array<FacedSurface, kProximitySensors> ProximityRing::faced(const SensorView& view) const {
    std::array<FacedSurface, kProximitySensors> faced;
    const double cosine = std::cos(view.robot.heading);
    const double sine = std::sin(view.robot.heading);
    for (std::size_t i = 0; i < kProximitySensors; ++i) {
        faced[i].distance = parameters_.reach;
        const Ray ray = in_world(view.robot, cosine, sine, rays_[i][rays_[i].size() / 2]);
        for (const Shape* shape : view.shapes)
            if (const auto hit = chord_before(*shape, ray.x, ray.y, ray.dx, ray.dy, faced[i].distance))
                faced[i] = {std::max(hit->in, 0.0), std::acos(std::clamp(hit->cosine, 0.0, 1.0))};
    }
    return faced;
}

std::array<double, kProximitySensors>
ProximityRing::answer(const std::array<double, kProximitySensors>& reflected, const Surroundings& now) const {
    const auto& p = parameters_;
    double scale = p.scale * (1.0 - p.ambient_gain * now.ambient);
    if (p.battery_gain != 0.0) scale *= 1.0 + p.battery_gain * (now.battery - kBatteryReference);
    if (p.warmup_gain != 0.0) scale *= 1.0 + p.warmup_gain * warmed_up(now.seconds, p.warmup_time);
    std::array<double, kProximitySensors> counts{};
    for (std::size_t i = 0; i < kProximitySensors; ++i) {
        const double pair = reflected[(i + 4) % kProximitySensors];
        const double neighbours =
            reflected[(i + 1) % kProximitySensors] + reflected[(i + 7) % kProximitySensors];
        const double seen = reflected[i] + p.pair_crosstalk * pair + p.neighbour_crosstalk * neighbours;
        const double whole = scale * p.gain[i] * seen + p.offset[i] + p.ambient_offset * now.ambient;
        counts[i] = whole * (1.0 - p.motor_sag * now.motors);
    }
    return counts;
}

std::array<double, kProximitySensors>
ProximityRing::readable(std::array<double, kProximitySensors> counts) const {
    for (double& count : counts) {
        count = std::clamp(count, 0.0, kProximityFullScale);
        if (count < parameters_.threshold) count = 0.0;
    }
    return counts;
}

}  // namespace puckloop::physics
