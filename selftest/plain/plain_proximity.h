#pragma once
// The eight infra-red sensors before a flat wall, written from the effects sheet's section B and the measured
// response table of the physics sheet. With every knob at rest: five rays a sensor over 0.1 rad, cosine of
// incidence, the response table, a fixed offset a sensor, noise of the two conversions.

#include "base/random.h"
#include "selftest/plain/noise.h"

#include <array>
#include <vector>

namespace puckloop::gap::selftest {

inline constexpr std::size_t kRing = 8;

/// What may be wrong. Numbers of the effects sheet in brackets.
struct ProximityKnobs {
    std::array<double, kRing> gain{1, 1, 1, 1, 1, 1, 1, 1};  // [18]
    std::array<double, kRing> offset{};                      // [19] counts added
    std::array<double, kRing> turned{};                      // [28] rad added to the direction
    double exponent = 2.0;      // [20] of the power law, the answer at 20 mm left alone
    double saturation = 4095;   // [21] counts, of the power law
    double light_gain = 0.0;    // [22] share of the ambient counts / 4095 by which the answer falls
    double light_offset = 0.0;  // [22] counts a unit of ambient
    double light_noise = 0.0;   // [22] counts a root of the ambient level
    double flicker = 0.0;       // [23] counts at ambient level 1
    double hits = 0.0;          // [24] probability that a sample is hit
    double hit_counts = 0.0;    // [24]
    double pair = 0.0;          // [25] share of the sensor on the same pulse
    double neighbours = 0.0;    // [25] share of each neighbour
    double surface = 1.0;       // [26] true over stated reflectivity, of surfaces stated below 1
    double incidence = 1.0;     // [27] m of cos^m
    double motor_noise = 0.0;   // [29] sd grows by this at 800 steps/s
    double sag = 0.0;           // [31] all channels shrink by this with both motors on
    double age = 0.0;           // [32] s
    double warm_gain = 0.0;     // [33]
    double warm_time = 300.0;   // [33] s
    double per_volt = 0.0;      // [64] share of the answer a volt
    double per_run = 0.0;       // [66] share of the answer a run
    double dead_zone = 0.0;     // [34] counts
    double noise_share = 0.0;   // [35] sd as a share of the level
    double fringe = 0.0;        // unknown: share, rippling with distance
    double notch = 0.0;         // unknown: share lost where the wall is 25-35 mm away
    double swing = 0.0;         // unknown: share lost, with the incidence as sin^2 3a
    double step = 0.0;          // unknown: share lost by sensors 2 and 3 in spells
};

/// What is before the robot at one time: a flat wall that one sensor looks at.
struct Scene {
    double t;             ///< s since power-up
    std::size_t sensor;   ///< the one that is looked at
    double gap;           ///< m along that sensor's axis to the wall
    double incidence;     ///< rad from the wall's normal to that axis
    double closing;       ///< m/s by which the gap falls
    double reflectivity;  ///< as stated
    double ambient;       ///< 0 dark, 1 a room
    double motors;        ///< steps/s of both wheels, 0 off
    double share;         ///< how much of the run has passed, 0..1
    double volts;         ///< of the battery, from its mean over all runs
    double order;         ///< of the run, from the mean over all runs
};

/// Nominal direction of a sensor's axis in the robot's frame, rad, + left.
double nominal_direction(std::size_t sensor);

struct RingReading {
    std::array<double, kRing> proximity, ambient;
};

/// The power law A / (d + d0)^2, d in mm, compressed at 4095: what is assumed of some robots in place of the
/// table.
inline constexpr double kLawAmplitude = 4.17e5;  // counts
inline constexpr double kLawOrigin = 0.0099;     // m

/// Without noise, but with what chance does of itself (hits). `law`: of a robot with the power law.
RingReading see(const ProximityKnobs& knobs, const Scene& scene, bool law, RandomStream& chance);

/// The factor and addition by which noise grows in this scene: sd = sqrt(base^2 factor^2 + extra^2).
struct NoiseGrowth {
    double factor, extra;
};
NoiseGrowth noise_growth(const ProximityKnobs& knobs, const Scene& scene, double level);

}  // namespace puckloop::gap::selftest
