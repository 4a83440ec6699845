#include "physics/sensors/sound_waves.h"

#include "physics/sensors/sensor_view.h"

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {
constexpr double kSpeakerReference = 0.1;  // m, where a speaker's level holds
constexpr double kNearestEar = 1e-3;       // m
/// Longest line between two samples: the period of the slowest codec.
constexpr double kLongestLine = 250e-6;  // s
constexpr double kHold = 5e-3;           // s
constexpr double kSettle = 2e-3;         // s
constexpr double kInaudible = 0.05;      // s, 22 times that after the hold

/// What is left of a value that stands for so long.
double held(double value, double seconds) {
    return seconds < kHold ? value : value * std::exp(-(seconds - kHold) / kSettle);
}
}  // namespace

void SoundTrack::change(double seconds, double value) {
    changes_.push_back({seconds, value});
}

double SoundTrack::at(double seconds) const {
    const auto after =
        std::upper_bound(changes_.begin(), changes_.end(), seconds,
                         [](double time, const Change& change) { return time < change.seconds; });
    if (after == changes_.begin()) return 0.0;
    const Change& last = *std::prev(after);
    const Change before = after == std::next(changes_.begin()) ? Change{} : *std::prev(after, 2);
    const double line = std::min(last.seconds - before.seconds, kLongestLine);
    const double into = seconds - last.seconds;
    if (into >= line) return held(last.value, into);
    const double from = held(before.value, last.seconds - before.seconds);
    return from + (last.value - from) * (into / line);
}

bool SoundTrack::silent_from(double seconds) const {
    if (changes_.empty()) return true;
    const double quiet = changes_.back().value == 0.0 ? kLongestLine : kInaudible;
    return changes_.back().seconds + quiet <= seconds;
}

void SoundTrack::forget(double seconds) {
    while (changes_.size() > 2 && changes_[2].seconds < seconds)
        changes_.pop_front();
    if (silent_from(seconds)) changes_.clear();
}

std::array<SoundWay, kMicrophones> sound_ways(const MicrophoneParameters& p, const RobotState& robot,
                                              double seconds, double x, double y, double height) {
    const double cosine = std::cos(robot.heading), sine = std::sin(robot.heading);
    const double warm = 1.0 + p.warmup_gain * warmed_up(seconds, p.warmup_time);
    std::array<SoundWay, kMicrophones> ways{};
    for (std::size_t i = 0; i < kMicrophones; ++i) {
        const Ray ear = in_world(robot, cosine, sine,
                                 {p.x[i], p.y[i], std::cos(p.direction[i]), std::sin(p.direction[i])});
        const double dx = x - ear.x, dy = y - ear.y;
        const double distance = std::max(std::hypot(dx, dy, height - p.height), kNearestEar);
        const double facing = (dx * ear.dx + dy * ear.dy) / distance;
        ways[i] = {distance, std::pow(kSpeakerReference / distance, p.exponent) *
                                 std::max(1.0 + p.directivity * facing, 0.0) * p.gain[i] * warm};
    }
    return ways;
}

}  // namespace puckloop::physics
