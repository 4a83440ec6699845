#include "selftest/plain/plain_ground.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kBlack = 329, kWhite = 953, kSaturation = 967;
constexpr double kAhead = 0.030;                                        // m
constexpr std::array<double, kGroundRow> kAside{0.0105, 0.0, -0.0105};  // m, left, centre, right
constexpr double kFootprint = 0.004;                                    // m
constexpr double kWaveLength = 0.08;                                    // m of the printed pattern
constexpr double kWeave = 0.007;                                        // m from ripple to ripple
constexpr double kHysteresisHold = 0.3;                                 // s

double grey_spot(double x, double y) {
    constexpr double r = kFootprint / 2;
    return (printed_grey(x, y) + printed_grey(x + r, y) + printed_grey(x - r, y) + printed_grey(x, y + r) +
            printed_grey(x, y - r)) /
           5;
}

/// The stand at an earlier time, between the rows.
Stand earlier(const std::vector<Stand>& stands, std::size_t row, double lag) {
    const double t = stands[row].t - lag;
    std::size_t k = row;
    while (k > 0 && stands[k].t > t)
        --k;
    if (k == row || lag <= 0.0) return stands[row];
    const Stand &a = stands[k], &b = stands[k + 1];
    const double f = std::clamp((t - a.t) / (b.t - a.t), 0.0, 1.0);
    Stand s = stands[row];
    s.x = a.x + f * (b.x - a.x);
    s.y = a.y + f * (b.y - a.y);
    s.heading = a.heading + f * (b.heading - a.heading);
    return s;
}

}  // namespace

double printed_grey(double x, double y) {
    // Smooth waves across x, and plain fields beyond them: all greys, known slopes.
    const double wave = 0.5 + 0.5 * std::sin(2 * std::numbers::pi * x / kWaveLength);
    const double bend = 0.5 + 0.5 * std::cos(2 * std::numbers::pi * y / (3 * kWaveLength));
    return 0.15 + 0.85 * wave * (0.4 + 0.6 * bend) - 0.1;
}

double nominal_grey(const Stand& s, std::size_t i, double ahead, double aside) {
    const double c = std::cos(s.heading), n = std::sin(s.heading);
    const double forward = kAhead + ahead, left = kAside[i] + aside;
    return grey_spot(s.x + c * forward - n * left, s.y + n * forward + c * left);
}

std::vector<std::array<double, kGroundRow>> look_down(const GroundKnobs& k,
                                                      const std::vector<Stand>& stands) {
    std::vector<std::array<double, kGroundRow>> rows;
    std::array<double, kGroundRow> dark_until{};
    for (std::size_t r = 0; r < stands.size(); ++r) {
        const Stand s = earlier(stands, r, k.lag);
        const double c = std::cos(s.heading), n = std::sin(s.heading);
        std::array<double, kGroundRow> reading{};
        for (std::size_t i = 0; i < kGroundRow; ++i) {
            const double ahead = kAhead + k.forward;
            const double x = s.x + c * ahead - n * kAside[i];
            const double y = s.y + n * ahead + c * kAside[i];
            const double grey = grey_spot(x, y);
            double level = kBlack + (kWhite - kBlack) * grey;
            level *= 1.0 - k.pitch * s.acceleration;
            level = k.gain[i] * level + k.offset[i];
            level += k.weave * std::sin(2 * std::numbers::pi * (x + y) / kWeave);
            if (grey < 0.1) dark_until[i] = s.t + kHysteresisHold;
            if (grey > 0.5 && s.t < dark_until[i]) level *= 1.0 - k.hysteresis;
            if (n > 0.5) level += k.glare;
            reading[i] = std::clamp(level, 0.0, kSaturation);
        }
        rows.push_back(reading);
    }
    return rows;
}

}  // namespace puckloop::gap::selftest
