#include "physics/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr double kFullScale = 4095;

/// Does anything stand on the line from (sensor, height) to the lamp, `level` metres away in plan?
bool shaded(const SensorView& view, const Ray& line, double height, const Lamp& lamp, double level) {
    const double rise = level > 0.0 ? (lamp.height - height) / level : 0.0;
    return std::any_of(view.shapes.begin(), view.shapes.end(), [&](const Shape* shape) {
        const auto hit = chord(*shape, line.x, line.y, line.dx, line.dy);
        if (!hit || hit->out <= 0.0 || hit->in >= level) return false;
        const double in = height + rise * std::max(hit->in, 0.0);
        const double out = height + rise * std::min(hit->out, level);
        return std::min(in, out) < shape->height;
    });
}

}  // namespace

LightRing::LightRing(const LightParameters& parameters, const ProximityParameters& places,
                     double ambient_level, std::span<const Lamp> lamps)
    : parameters_(parameters), height_(places.height), ambient_level_(ambient_level), lamps_(lamps) {
    for (std::size_t i = 0; i < kProximitySensors; ++i)
        sensors_[i] = {places.x[i], places.y[i], std::cos(places.direction[i]),
                       std::sin(places.direction[i])};
}

double LightRing::from_lamp(const SensorView& view, const Lamp& lamp, const Ray& sensor) const {
    const double dx = lamp.x - sensor.x;
    const double dy = lamp.y - sensor.y;
    const double level = std::hypot(dx, dy);
    const double distance = std::hypot(level, lamp.height - height_);
    if (distance >= parameters_.range || distance <= 0.0) return 0.0;
    const double cosine = std::clamp((dx * sensor.dx + dy * sensor.dy) / distance, -1.0, 1.0);
    const double facing = 1.0 - std::acos(cosine) * 2.0 / std::numbers::pi;
    if (facing <= 0.0) return 0.0;
    const Ray line{sensor.x, sensor.y, level > 0.0 ? dx / level : 1.0, level > 0.0 ? dy / level : 0.0};
    if (shaded(view, line, height_, lamp, level)) return 0.0;
    return lamp.intensity * std::exp(-parameters_.decay * distance) * facing;
}

std::array<double, kProximitySensors> LightRing::sense(const SensorView& view) const {
    const auto& p = parameters_;
    const double cosine = std::cos(view.robot.heading);
    const double sine = std::sin(view.robot.heading);
    double room = p.room * ambient_level_;
    if (p.flicker > 0.0)
        room *= 1.0 + p.flicker * std::sin(2 * std::numbers::pi * p.flicker_frequency * view.seconds);
    std::array<double, kProximitySensors> counts{};
    for (std::size_t i = 0; i < kProximitySensors; ++i) {
        const Ray sensor = in_world(view.robot, cosine, sine, sensors_[i]);
        double light = room;
        for (const Lamp& lamp : lamps_)
            light += from_lamp(view, lamp, sensor);
        counts[i] = std::clamp(p.dark + p.offset[i] - p.span * p.gain[i] * light, 0.0, kFullScale);
    }
    return counts;
}

}  // namespace puckloop::physics
