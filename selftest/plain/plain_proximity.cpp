#include "selftest/plain/plain_proximity.h"

#include "physics/description/robot_constants.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kPlainProximityFullScale = 4095;
constexpr double kReach = 0.12;  // m
constexpr int kRays = 5;
constexpr double kAperture = 0.1;                              // rad, full
constexpr double kFlickerHertz = 100;                          // twice the mains
constexpr double kSensorPeriod = 1 / physics::kProximityRate;  // s between two samples of one sensor
constexpr double kMotorReference = 800;                        // steps/s
constexpr double kDark = 4000;                                 // counts of the light channel without light
constexpr double kRoom = 300;                                  // counts lost at ambient level 1
constexpr double kLawReference = 20;  // mm: where a changed exponent leaves the answer alone
constexpr double kSpells = 11;        // a run, of loose and of good contact
constexpr double kFringe = 6;         // mm from ripple to ripple

struct Place {
    double x, y, degrees, idle;
};
/// Positions (m), directions and idle counts of the sensors.
constexpr std::array<Place, kRing> kPlaces{{{.030, -.010, -17.2, 52},
                                            {.022, -.025, -45.9, 47},
                                            {.0, -.031, -90.0, 60},
                                            {-.030, -.015, -151.5, 55},
                                            {-.030, .015, 151.2, 49},
                                            {.0, .031, 90.0, 63},
                                            {.022, .025, 45.8, 58},
                                            {.030, .010, 17.1, 45}}};

/// Counts of a white wall straight ahead against millimetres, straight lines between.
constexpr std::array<std::pair<double, double>, 12> kAnswer{{{0, 4095},
                                                             {5, 2133.33},
                                                             {10, 1465.73},
                                                             {15, 601.46},
                                                             {20, 383.84},
                                                             {30, 234.93},
                                                             {40, 158.03},
                                                             {50, 120.00},
                                                             {60, 104.09},
                                                             {70, 67.19},
                                                             {100, 20},
                                                             {120, 0}}};

double answer(double mm) {
    if (mm <= 0) return kAnswer.front().second;
    for (std::size_t k = 1; k < kAnswer.size(); ++k) {
        if (mm > kAnswer[k].first) continue;
        const double part = (mm - kAnswer[k - 1].first) / (kAnswer[k].first - kAnswer[k - 1].first);
        return kAnswer[k - 1].second * (1 - part) + kAnswer[k].second * part;
    }
    return 0.0;
}

double changed_answer(const ProximityKnobs& k, double metres, bool law) {
    const double mm = metres * 1e3;
    double counts = answer(mm);
    if (law) {
        const double origin = kLawOrigin * 1e3;
        const double reference = kLawAmplitude / std::pow(kLawReference + origin, 2.0);
        counts = reference * std::pow((mm + origin) / (kLawReference + origin), -k.exponent);
        counts = 1.0 / (1.0 / counts + 1.0 / k.saturation);
    }
    counts *= 1.0 + k.fringe * std::sin(2 * std::numbers::pi * mm / kFringe);
    if (mm > 25 && mm < 35) counts *= 1.0 - k.notch;
    return counts;
}

double reflected(const ProximityKnobs& k, const Scene& s, std::size_t sensor, double gap, bool law) {
    const Place& place = kPlaces[sensor];
    const Place& looked_at = kPlaces[s.sensor];
    const double bearing = nominal_direction(s.sensor) - s.incidence;
    const double nx = std::cos(bearing), ny = std::sin(bearing);
    const double distance = nx * looked_at.x + ny * looked_at.y + gap * std::cos(s.incidence);
    double sum = 0.0;
    for (int ray = 0; ray < kRays; ++ray) {
        const double spread = kAperture * (ray / (kRays - 1.0) - 0.5);
        const double way = place.degrees * std::numbers::pi / 180 + k.turned[sensor] + spread;
        const double cosine = nx * std::cos(way) + ny * std::sin(way);
        if (cosine <= 0.0) continue;
        const double length = (distance - nx * place.x - ny * place.y) / cosine;
        if (length > kReach) continue;
        sum += std::pow(cosine, k.incidence) * changed_answer(k, std::max(length, 0.0), law);
    }
    const double surface = s.reflectivity < 1.0 ? s.reflectivity * k.surface : s.reflectivity;
    return surface * sum / kRays;
}

}  // namespace

double nominal_direction(std::size_t sensor) {
    return kPlaces[sensor].degrees * std::numbers::pi / 180;
}

RingReading see(const ProximityKnobs& k, const Scene& s, bool law, RandomStream& chance) {
    std::array<double, kRing> own{};
    const double gap = s.gap + s.closing * k.age;
    for (std::size_t i = 0; i < kRing; ++i)
        own[i] = reflected(k, s, i, gap, law);
    const double lit = kRoom * s.ambient;
    const double warm = (1.0 + k.warm_gain * (1.0 - std::exp(-s.t / k.warm_time))) *
                        (1.0 + k.per_volt * s.volts) * (1.0 + k.per_run * s.order);
    const double bright = 1.0 - k.light_gain * lit / kPlainProximityFullScale;
    // Nothing head-on, where a sensor's swing would be no other than its gain.
    const double swing = 1.0 - k.swing * std::pow(std::sin(3 * s.incidence), 2);
    const double sampled = std::floor(s.t / kSensorPeriod) * kSensorPeriod;
    const double sag = s.motors != 0.0 ? 1.0 - k.sag : 1.0;
    RingReading reading{};
    for (std::size_t i = 0; i < kRing; ++i) {
        double seen = own[i] + k.pair * own[(i + 4) % kRing] +
                      k.neighbours * (own[(i + 1) % kRing] + own[(i + kRing - 1) % kRing]);
        if ((i == 2 || i == 3) && std::fmod(kSpells * s.share, 1.0) > 0.5) seen *= 1.0 - k.step;
        double counts = warm * bright * swing * k.gain[i] * seen + kPlaces[i].idle + k.offset[i] +
                        k.light_offset * s.ambient;
        counts += k.flicker * s.ambient *
                  std::sin(2 * std::numbers::pi * kFlickerHertz * sampled + 0.4 * static_cast<double>(i));
        const bool exposed = i == 0 || i == 1 || i == 6 || i == 7;
        const double hit = chance.uniform();
        if (exposed && hit < k.hits) counts += hit < k.hits / 2 ? k.hit_counts : -k.hit_counts;
        if (k.dead_zone > 0.0 && counts < k.dead_zone) counts = 0.0;
        reading.proximity[i] = std::clamp(counts * sag, 0.0, kPlainProximityFullScale);
        reading.ambient[i] = std::clamp((kDark - lit) * sag, 0.0, kPlainProximityFullScale);
    }
    return reading;
}

NoiseGrowth noise_growth(const ProximityKnobs& k, const Scene& s, double level) {
    const double share = k.noise_share * level;
    const double light = k.light_noise * std::sqrt(std::max(s.ambient, 0.0));
    return {1.0 + k.motor_noise * std::abs(s.motors) / kMotorReference, std::hypot(share, light)};
}

}  // namespace puckloop::gap::selftest
