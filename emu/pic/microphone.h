#pragma once
// The waveform at a microphone's amplifier: white Gaussian noise as loud as a stated volume.
//
// Deviations: 1. no pitch, no phase between the microphones. 2. Each conversion draws a new value, however
// soon it follows: the noise has no bandwidth.

#include "base/random.h"

#include <cstdint>
#include <string>

namespace puckloop::pic {

/// Largest minus smallest of 100 standard normal samples, expected: what the firmware's window of 100 sees.
inline constexpr double kRangeOfWindow = 5.0152;

class Microphone {
  public:
    Microphone(std::uint64_t seed, const std::string& stream) : noise_(seed, stream) {}

    /// What stands at the input beside its rest value, counts. `level`: volume, counts; at 0 nothing is
    /// drawn. `lost`: share of samples, 0..1, that hold the one before.
    double sample(double level, double lost) {
        if (!(level > 0.0)) return held_ = 0.0;
        if (lost > 0.0 && noise_.uniform() < lost) return held_;
        return held_ = level / kRangeOfWindow * noise_.normal();
    }
    /// The stream begins anew.
    void renew(std::uint64_t seed, const std::string& stream) { noise_ = RandomStream(seed, stream); }

    template <class Archive>
    void state(Archive& archive) {
        archive(noise_);
        archive.bounded(held_, -1e6, 1e6);
    }

  private:
    RandomStream noise_;
    double held_ = 0.0;
};

}  // namespace puckloop::pic
