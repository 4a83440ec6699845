#include "physics/ground.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kDrawnHeight = 0.0015;  // m over the floor: where black and white were measured
constexpr double kLeastSignal = 0.05;    // of the nominal signal, however high the sensor is
constexpr double kMostSignal = 1.2;

bool covers(const Patch& patch, double x, double y) {
    const double dx = x - patch.x;
    const double dy = y - patch.y;
    if (patch.shape == Patch::Shape::Disc) return dx * dx + dy * dy <= patch.radius * patch.radius;
    const double cosine = std::cos(patch.heading);
    const double sine = std::sin(patch.heading);
    return std::abs(cosine * dx + sine * dy) <= patch.length / 2 &&
           std::abs(cosine * dy - sine * dx) <= patch.width / 2;
}

}  // namespace

double floor_grey(double base, std::span<const Patch> patches, double x, double y) {
    for (auto i = patches.size(); i-- > 0;)
        if (covers(patches[i], x, y)) return patches[i].grey;
    return base;
}

GroundRow::GroundRow(const GroundParameters& parameters, double base_grey, std::span<const Patch> patches)
    : parameters_(parameters), base_grey_(base_grey), patches_(patches) {}

std::array<double, kGroundSensors> GroundRow::greys(const RobotState& robot) const {
    const auto& p = parameters_;
    const double cosine = std::cos(robot.heading);
    const double sine = std::sin(robot.heading);
    const double reach = p.footprint / 2;
    const std::array<Point, 5> spots{{{0, 0}, {reach, 0}, {-reach, 0}, {0, reach}, {0, -reach}}};
    std::array<double, kGroundSensors> greys{};
    for (std::size_t i = 0; i < kGroundSensors; ++i) {
        const double x = robot.x + cosine * p.x - sine * p.y[i];
        const double y = robot.y + sine * p.x + cosine * p.y[i];
        for (const Point& spot : spots)
            greys[i] += floor_grey(base_grey_, patches_, x + spot.x, y + spot.y);
        greys[i] /= static_cast<double>(spots.size());
    }
    return greys;
}

std::array<double, kGroundSensors> GroundRow::counts(const std::array<double, kGroundSensors>& greys,
                                                     const RobotState& robot, const GroundMoment& now) const {
    const auto& p = parameters_;
    const double pitch = robot.pitch - p.acceleration_tilt * now.acceleration;  // nose down is positive
    const double warm =
        p.warmup_gain == 0.0 ? 1.0 : 1.0 + p.warmup_gain * warmed_up(now.seconds, p.warmup_time);
    std::array<double, kGroundSensors> counts{};
    for (std::size_t i = 0; i < kGroundSensors; ++i) {
        const double lift = p.height - kDrawnHeight - p.x * std::sin(pitch) + p.y[i] * std::sin(robot.roll);
        const double signal =
            now.no_floor ? 0.0 : std::clamp(1.0 - p.height_slope * lift, kLeastSignal, kMostSignal);
        const double level = (p.black + (p.white - p.black) * greys[i]) * signal * warm;
        counts[i] = std::clamp(p.gain[i] * level + p.offset[i], 0.0, p.saturation);
    }
    return counts;
}

}  // namespace puckloop::physics
