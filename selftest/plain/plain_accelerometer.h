#pragma once
// A three-axis accelerometer in counts, written from the effects sheet, 31, 39 and 40. At rest of all knobs:
// zero at 2048, 800 counts a g, axes right, rear, up.

#include <array>
#include <vector>

namespace puckloop::gap::selftest {

inline constexpr std::size_t kAxes = 3;

struct AccelerometerKnobs {
    std::array<double, kAxes> bias{};          // [39] counts
    std::array<double, kAxes> scale{1, 1, 1};  // [39]
    double turned = 0.0;                       // [39] rad between board and robot about the vertical axis
    double vibration = 0.0;                    // [40] counts sd at 1000 steps/s
    double session_jump = 0.0;                 // [39] counts, another bias after power-up again
    double sag = 0.0;                          // [31] all channels shrink with the motors on
    double warm = 0.0;                         // [33] counts in the end, 95 % after ten minutes
    double spin_pull = 0.0;                    // unknown: counts on x while turning left only
    double hold = 0.0;                         // unknown: counts added in the seconds after a stop
};

/// What the robot did at one time.
struct Attitude {
    double t;              ///< s since power-up
    double pitch, roll;    ///< rad, nose up and left side up positive
    double forward, left;  ///< m/s2 of the robot, not gravity
    double steps;          ///< steps/s of the wheels, mean of both magnitudes
    double turning;        ///< steps/s, right minus left wheel
    double since_stop;     ///< s, large if it never moved
    int session;
};

/// Counts without noise, right, rear, up.
std::array<double, kAxes> feel(const AccelerometerKnobs& knobs, const Attitude& attitude);

}  // namespace puckloop::gap::selftest
