#pragma once
// Sound as it travels: waves of robots' speakers at a robot's microphones. (Loudspeakers of a scenario are
// noise and known by their level only: sound.h.)
//
// A microphone hears at s what a source d away made at s - d/c - kSoundLatency. Deviations: 1. the latency:
// what the world publishes is stamped a step after it, and a step's wave goes out at once. 2. Straight ways
// only: no reflection, no shade, no air absorption. 3. Speakers and microphones are even and linear up to 4
// kHz and point sources; a source and an ear keep their places for a step. 4. Samples lie 62.5 us apart,
// which ends at 8 kHz.

#include "cosim/core/time.h"
#include "physics/description/parameters.h"
#include "physics/dynamics/dynamics.h"

#include <array>
#include <cstddef>
#include <deque>

namespace puckloop::physics {

inline constexpr double kSpeedOfSound = 343.0;    ///< m/s, in air at 20 degrees
inline constexpr double kSoundLatency = 2e-3;     ///< s, beside the way
inline constexpr std::size_t kSoundSamples = 16;  ///< a step
inline constexpr cosim::Time kSoundPeriod = cosim::kMillisecond / kSoundSamples;

/// What drives a speaker over time. It is informed of changes; between two that follow each other closely the
/// wave is a straight line, as a converter's filter would have it.
/// What stays is no sound and dies away within some milliseconds.
class SoundTrack {
  public:
    /// `value` from `seconds` on; times rise.
    void change(double seconds, double value);
    /// Somewhere in the last `forget()` span; one line per change late.
    double at(double seconds) const;
    /// Nothing but silence from `seconds` on.
    bool silent_from(double seconds) const;
    /// Nobody asks for what was before `seconds` any more.
    void forget(double seconds);

  private:
    struct Change {
        double seconds = 0.0, value = 0.0;
    };
    std::deque<Change> changes_;
};

/// From a place to one of a robot's microphones.
struct SoundWay {
    double distance = 0.0;  ///< m
    double share = 0.0;     ///< of the level 0.1 m before a plain microphone
};
/// By the law of sound.h. `seconds`: the microphones warm up.
std::array<SoundWay, kMicrophones> sound_ways(const MicrophoneParameters& parameters, const RobotState& robot,
                                              double seconds, double x, double y, double height);

}  // namespace puckloop::physics
