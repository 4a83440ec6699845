#include "physics/sensors/light.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr double kLightFullScale = 4095;

constexpr double kDistanceRounding = 1e-6;  // m: far above any rounding of a distance here

/// Does any of them stand on the line from (sensor, height) to the lamp, `level` metres away in plan?
bool shaded(std::span<const Shape* const> shapes, const Ray& line, double height, const Lamp& lamp,
            double level) {
    const double rise = level > 0.0 ? (lamp.height - height) / level : 0.0;
    return std::any_of(shapes.begin(), shapes.end(), [&](const Shape* shape) {
        const auto hit = chord_before(*shape, line.x, line.y, line.dx, line.dy, level);
        if (!hit || hit->out <= 0.0) return false;
        const double in = height + rise * std::max(hit->in, 0.0);
        const double out = height + rise * std::min(hit->out, level);
        return std::min(in, out) < shape->height;
    });
}

}  // namespace

LightRing::LightRing(const LightParameters& parameters, const ProximityParameters& places,
                     double ambient_level, std::span<const Lamp> lamps)
    : parameters_(parameters), height_(places.height), ambient_level_(ambient_level), lamps_(lamps) {
    for (std::size_t i = 0; i < kProximitySensors; ++i) {
        sensors_[i] = {places.x[i], places.y[i], std::cos(places.direction[i]),
                       std::sin(places.direction[i])};
        ring_ = std::max(ring_, std::hypot(places.x[i], places.y[i]));
    }
}

/// Is any sensor of a robot there within the lamp's range?
bool LightRing::reaches(const Lamp& lamp, const RobotState& robot) const {
    const double dx = lamp.x - robot.x, dy = lamp.y - robot.y;
    const double far = parameters_.range + ring_ + kDistanceRounding;
    return dx * dx + dy * dy <= far * far;
}

/// All lines from the sensors to a lamp lie within ring_ of the line from the robot's middle to it.
void LightRing::look_between(const SensorView& view, const Lamp& lamp) {
    const double dx = lamp.x - view.robot.x, dy = lamp.y - view.robot.y;
    const double length2 = dx * dx + dy * dy;
    between_.clear();
    for (const Shape* shape : view.shapes) {
        const double x = shape->x - view.robot.x, y = shape->y - view.robot.y;
        const double along = length2 > 0.0 ? std::clamp((x * dx + y * dy) / length2, 0.0, 1.0) : 0.0;
        const double away_x = x - along * dx, away_y = y - along * dy;
        const double near = shape->radius + ring_ + kDistanceRounding;
        if (away_x * away_x + away_y * away_y <= near * near) between_.push_back(shape);
    }
}

double LightRing::from_lamp(const Lamp& lamp, const Ray& sensor,
                            std::span<const Shape* const> between) const {
    const double dx = lamp.x - sensor.x;
    const double dy = lamp.y - sensor.y;
    const double towards = dx * sensor.dx + dy * sensor.dy;
    if (towards <= 0.0) return 0.0;  // it faces away
    const double level = std::hypot(dx, dy);
    const double distance = std::hypot(level, lamp.height - height_);
    if (distance >= parameters_.range || distance <= 0.0) return 0.0;
    const double cosine = std::clamp(towards / distance, -1.0, 1.0);
    const double facing = 1.0 - std::acos(cosine) * 2.0 / std::numbers::pi;
    if (facing <= 0.0) return 0.0;
    const Ray line{sensor.x, sensor.y, level > 0.0 ? dx / level : 1.0, level > 0.0 ? dy / level : 0.0};
    if (shaded(between, line, height_, lamp, level)) return 0.0;
    return lamp.intensity * std::exp(-parameters_.decay * distance) * facing;
}

std::array<double, kProximitySensors> LightRing::sense(const SensorView& view) {
    const auto& p = parameters_;
    double room = p.room * ambient_level_;
    if (p.flicker > 0.0)
        room *= 1.0 + p.flicker * std::sin(2 * std::numbers::pi * p.flicker_frequency * view.seconds);
    std::array<double, kProximitySensors> light;
    light.fill(room);
    const double cosine = std::cos(view.robot.heading);
    const double sine = std::sin(view.robot.heading);
    for (const Lamp& lamp : lamps_) {
        if (!reaches(lamp, view.robot)) continue;
        look_between(view, lamp);
        for (std::size_t i = 0; i < kProximitySensors; ++i)
            light[i] += from_lamp(lamp, in_world(view.robot, cosine, sine, sensors_[i]), between_);
    }
    std::array<double, kProximitySensors> counts{};
    for (std::size_t i = 0; i < kProximitySensors; ++i)
        counts[i] = std::clamp(p.dark + p.offset[i] - p.span * p.gain[i] * light[i], 0.0, kLightFullScale);
    return counts;
}

}  // namespace puckloop::physics
