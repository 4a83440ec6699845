#pragma once
// Three ground sensors over a floor printed with smooth waves of grey, written from the effects sheet, 36-38.
// With every knob at rest: levels of black and white, a five-point footprint of 4 mm, 30 mm before the axle.

#include "base/random.h"

#include <array>
#include <cstddef>
#include <vector>

namespace puckloop::gap::selftest {

inline constexpr std::size_t kGroundRow = 3;

/// What may be wrong. Numbers of the effects sheet in brackets.
struct GroundKnobs {
    std::array<double, kGroundRow> gain{1, 1, 1};  // [36]
    std::array<double, kGroundRow> offset{};       // [36] counts
    double pitch = 0.0;                            // [37] share of the signal lost an m/s2 of acceleration
    double forward = 0.0;                          // [38] m further ahead than stated
    double lag = 0.0;                              // [38] s
    double weave = 0.0;                            // unknown: counts, rippling with the place on the floor
    double hysteresis = 0.0;  // unknown: share of the last change kept for a while after dark
    double glare = 0.0;       // unknown: counts where the robot heads north
};

/// Where the robot was.
struct Stand {
    double t, x, y, heading, speed, acceleration;
};

/// Printed grey, 0 black to 1 white, at a place.
double printed_grey(double x, double y);
/// Mean grey under sensor `i` by the nominal footprint, looked at `ahead` and `aside` (left) of its place, m.
double nominal_grey(const Stand& stand, std::size_t i, double ahead, double aside);

/// A run's readings without noise, for consecutive stands `period` apart.
std::vector<std::array<double, kGroundRow>> look_down(const GroundKnobs& knobs,
                                                      const std::vector<Stand>& stands);

}  // namespace puckloop::gap::selftest
