#include "physics/sensors/ground.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

constexpr double kDrawnHeight = 0.0015;  // m over the floor: where black and white were measured
constexpr double kLeastSignal = 0.05;    // of the nominal signal, however high the sensor is
constexpr double kMostSignal = 1.2;

constexpr std::size_t kSpots = 5;  // of a footprint

double mean_of(const std::array<double, kSpots>& greys) {
    double sum = 0.0;
    for (const double grey : greys)
        sum += grey;
    return sum / static_cast<double>(kSpots);
}

}  // namespace

GroundRow::GroundRow(const GroundParameters& parameters, double base_grey, std::span<const Patch> patches)
    : parameters_(parameters), reach_(0.0) {
    for (const double y : parameters.y)
        reach_ = std::max(reach_, std::hypot(parameters.x, y) + parameters.footprint / 2);
    set_floor(base_grey, patches);
}

void GroundRow::set_floor(double base_grey, std::span<const Patch> patches) {
    base_grey_ = base_grey;
    base_mean_ = mean_of({base_grey, base_grey, base_grey, base_grey, base_grey});
    covers_.clear();
    for (const Patch& patch : patches)
        covers_.push_back(
            {patch, std::cos(patch.heading), std::sin(patch.heading),
             patch.shape == Patch::Shape::Disc ? patch.radius : std::hypot(patch.length, patch.width) / 2});
}

bool GroundRow::Cover::at(double x, double y) const {
    const double dx = x - patch.x;
    const double dy = y - patch.y;
    if (patch.shape == Patch::Shape::Disc) return dx * dx + dy * dy <= patch.radius * patch.radius;
    return std::abs(cosine * dx + sine * dy) <= patch.length / 2 &&
           std::abs(cosine * dy - sine * dx) <= patch.width / 2;
}

double GroundRow::Cover::grey(double x, double y) const {
    if (patch.image.empty()) return patch.grey;
    const double dx = x - patch.x;
    const double dy = y - patch.y;
    return grey_of(patch.image.at(0.5 + (cosine * dx + sine * dy) / patch.length,
                                  0.5 + (cosine * dy - sine * dx) / patch.width));
}

/// May any spot of a robot there lie on a patch?
bool GroundRow::near_a_patch(double x, double y) const {
    constexpr double kRounding = 1e-6;
    return std::any_of(covers_.begin(), covers_.end(), [&](const Cover& cover) {
        const double dx = x - cover.patch.x, dy = y - cover.patch.y;
        const double far = reach_ + cover.radius + kRounding;
        return dx * dx + dy * dy <= far * far;
    });
}

/// 0 black .. 1 white; later patches lie on top.
double GroundRow::grey_at(double x, double y) const {
    for (auto i = covers_.size(); i-- > 0;)
        if (covers_[i].at(x, y)) return covers_[i].grey(x, y);
    return base_grey_;
}

/// Middle of what a sensor sees.
Point GroundRow::spot(const RobotState& robot, double cosine, double sine, std::size_t sensor) const {
    return {robot.x + cosine * parameters_.x - sine * parameters_.y[sensor],
            robot.y + sine * parameters_.x + cosine * parameters_.y[sensor]};
}

std::array<double, kGroundSensors> GroundRow::greys(const RobotState& robot) const {
    const auto& p = parameters_;
    if (!near_a_patch(robot.x, robot.y)) return {base_mean_, base_mean_, base_mean_};
    const double cosine = std::cos(robot.heading);
    const double sine = std::sin(robot.heading);
    const double reach = p.footprint / 2;
    std::array<double, kGroundSensors> greys{};
    for (std::size_t i = 0; i < kGroundSensors; ++i) {
        const auto [x, y] = spot(robot, cosine, sine, i);
        greys[i] = mean_of({grey_at(x, y), grey_at(x + reach, y), grey_at(x - reach, y),
                            grey_at(x, y + reach), grey_at(x, y - reach)});
    }
    return greys;
}

std::array<double, kGroundSensors> GroundRow::greys(const RobotState& robot,
                                                    std::span<const PheromoneField> trails) const {
    auto seen = greys(robot);
    if (trails.empty()) return seen;
    const double cosine = std::cos(robot.heading);
    const double sine = std::sin(robot.heading);
    for (std::size_t i = 0; i < kGroundSensors; ++i) {
        const auto [x, y] = spot(robot, cosine, sine, i);
        for (const PheromoneField& trail : trails)
            seen[i] = trail.over(seen[i], x, y);
    }
    return seen;
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
