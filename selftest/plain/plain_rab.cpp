#include "selftest/plain/plain_rab.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kBearingDegree = std::numbers::pi / 180;
constexpr std::array<double, kReceivers> kDirections{15,   50,   75,   105, 133, 159,
                                                     -165, -135, -105, -77, -50, -15};
constexpr std::array<double, 9> kLogMedian{7.64689, 7.59652, 7.24955, 7.08464, 6.9845,
                                           6.91745, 6.82319, 6.82855, 6.82855};
constexpr std::array<double, 9> kSpread{0.357061, 0.319231, 0.192649, 0.15294, 0.109233,
                                        0.121653, 0.153155, 0.141843, 0.141843};
constexpr double kFadingPeriod = 9.0;  // s

double between(const std::array<double, 9>& values, double distance) {
    const auto& d = kStrengthDistances;
    if (distance <= d.front()) return values.front();
    for (std::size_t k = 1; k < d.size(); ++k)
        if (distance <= d[k])
            return values[k - 1] + (values[k] - values[k - 1]) * (distance - d[k - 1]) / (d[k] - d[k - 1]);
    return values.back();
}

/// Direction of the sum of what the receivers measure; a receiver's strength goes with the root of the
/// cosine.
double vector_bearing(const std::array<double, kReceivers>& gain, double bearing) {
    double x = 0.0, y = 0.0;
    for (std::size_t i = 0; i < kReceivers; ++i) {
        const double way = kDirections[i] * kBearingDegree;
        const double facing = std::cos(bearing - way);
        if (facing <= 0.0) continue;
        x += gain[i] * std::sqrt(facing) * std::cos(way);
        y += gain[i] * std::sqrt(facing) * std::sin(way);
    }
    return std::atan2(y, x);
}

}  // namespace

double receiver_direction(std::size_t receiver) {
    return kDirections[receiver] * kBearingDegree;
}

double strength_spread(double distance) {
    return between(kSpread, distance);
}

Hearing hear(const RabKnobs& k, const Sending& s, RandomStream& chance) {
    double level = between(kLogMedian, s.distance) + std::log(k.gain[s.receiver]);
    // The error of the equal receivers' sum is the firmware's table, which is none here.
    constexpr std::array<double, kReceivers> kEqual{1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 1};
    double bearing =
        s.bearing + std::remainder(vector_bearing(k.gain, s.bearing) - vector_bearing(kEqual, s.bearing),
                                   2 * std::numbers::pi);
    const double path = chance.uniform();
    const double side = chance.normal();
    if (path < k.reflected) {
        level -= k.reflected_loss;
        bearing += 0.6 * side;
    }
    if (s.bearing > 0.8 && s.bearing < 2.4) level -= k.sector;
    level += k.fading * std::sin(2 * std::numbers::pi * s.t / kFadingPeriod);
    bearing += k.wander * std::sin(2 * s.bearing);
    const double others = s.senders - 1;
    double kept = std::exp(-2 * others * k.collisions * s.frame_time / s.send_period);
    kept *= 1.0 - k.loss;
    kept *= std::min(1.0, k.poll_rate / s.arrival_rate);
    const double beats = (s.t + s.beat_begun) / k.beat_period, phase = beats - std::floor(beats);
    if (phase < k.beat) kept = 0.0;
    const bool received = chance.uniform() < kept;
    const double light = std::max(std::exp(level), k.far_floor);
    return {received, light, std::min(light, k.saturation), std::remainder(bearing, 2 * std::numbers::pi)};
}

}  // namespace puckloop::gap::selftest
