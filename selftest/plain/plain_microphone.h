#pragma once
// The level of three microphones before a loudspeaker, written from the effects sheet, 41 and 42. With every
// knob at rest: the stated level at 0.1 m, falling with the distance.

#include <array>
#include <cstddef>

namespace puckloop::gap::selftest {

inline constexpr std::size_t kMicrophones = 3;

struct MicrophoneKnobs {
    std::array<double, kMicrophones> gain{1, 1, 1};  // [41]
    double self_noise = 0.0;                         // [41] counts, the floor of the level
    double exponent = 0.0;                           // [41] fall with distance, beyond 1
    double directivity = 0.0;                        // [41] share
    double short_window = 0.0;                       // [42] share of the window really used is 1 minus this
    double warm = 0.0;                               // [33] share in the end, 95 % after ten minutes
    double node = 0.0;                               // unknown: share, a room mode along the distance
    double burst = 0.0;                              // unknown: share lost in seven spells of each run
};

struct Listening {
    double t, distance, angle, amplitude;
    std::size_t microphone;
    double motors;  ///< steps/s
    double window;  ///< samples
    double share;   ///< of the run passed
};

/// Counts without noise.
double loudness(const MicrophoneKnobs& knobs, const Listening& listening);

}  // namespace puckloop::gap::selftest
