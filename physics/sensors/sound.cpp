#include "physics/sensors/sound.h"

#include "physics/description/robot_constants.h"
#include "physics/sensors/sensor_view.h"
#include "physics/sensors/speaker_wave.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {
constexpr double kSoundFullScale = 4095;
constexpr double kReference = 0.1;  // m, where a loudspeaker's level holds
constexpr double kNearest = 1e-3;   // m
}  // namespace

Ears::Ears(const MicrophoneParameters& parameters, std::span<const Speaker> speakers)
    : parameters_(parameters), speakers_(speakers) {}

bool Ears::any() const {
    return parameters_.self_noise > 0.0 || parameters_.motor_noise > 0.0 ||
           std::any_of(speakers_.begin(), speakers_.end(), [](const Speaker& one) { return !is_wave(one); });
}

std::array<double, kMicrophones> Ears::hear(const RobotState& robot, double seconds,
                                            double motor_speed) const {
    const auto& p = parameters_;
    const double cosine = std::cos(robot.heading), sine = std::sin(robot.heading);
    const double warm = 1.0 + p.warmup_gain * warmed_up(seconds, p.warmup_time);
    std::array<double, kMicrophones> levels{};
    for (std::size_t i = 0; i < kMicrophones; ++i) {
        const Ray ear = in_world(robot, cosine, sine,
                                 {p.x[i], p.y[i], std::cos(p.direction[i]), std::sin(p.direction[i])});
        double power = 0.0;
        for (const Speaker& speaker : speakers_) {
            if (is_wave(speaker) || !into_sound(speaker, seconds)) continue;
            const double dx = speaker.x - ear.x, dy = speaker.y - ear.y;
            const double distance = std::max(std::hypot(dx, dy, speaker.height - p.height), kNearest);
            const double facing = (dx * ear.dx + dy * ear.dy) / distance;
            const double level = speaker.level * std::pow(kReference / distance, p.exponent) *
                                 std::max(1.0 + p.directivity * facing, 0.0);
            power += level * level;
        }
        levels[i] = std::clamp(std::sqrt(power) * p.gain[i] * warm + p.self_noise +
                                   p.motor_noise * motor_speed / kSpeedUnit,
                               0.0, kSoundFullScale);
    }
    return levels;
}

}  // namespace puckloop::physics
