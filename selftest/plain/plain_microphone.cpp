#include "selftest/plain/plain_microphone.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {
constexpr double kReference = 0.1;   // m
constexpr double kRoomMode = 0.055;  // m from node to node
constexpr double kPlainSoundFullScale = 4095;
constexpr double kSoundWarmSeconds = 200.0;
constexpr double kSoundSpells = 7;  // a run, of less and of all
}  // namespace

double loudness(const MicrophoneKnobs& k, const Listening& l) {
    double level = l.amplitude * std::pow(kReference / l.distance, 1.0 + k.exponent);
    level *= 1.0 + k.directivity * std::cos(l.angle);
    level *= 1.0 + k.node * std::sin(2 * std::numbers::pi * l.distance / kRoomMode);
    level *= k.gain[l.microphone] * (1.0 + k.warm * (1.0 - std::exp(-l.t / kSoundWarmSeconds)));
    if (std::fmod(kSoundSpells * l.share, 1.0) > 0.5) level *= 1.0 - k.burst;
    level += k.self_noise;
    // Extremes of N samples of noise lie about sqrt(2 ln N) from the mean: fewer samples, a smaller level.
    const double used = std::max(2.0, l.window * (1.0 - k.short_window));
    level *= std::sqrt(std::log(used) / std::log(l.window));
    return std::clamp(level, 0.0, kPlainSoundFullScale);
}

}  // namespace puckloop::gap::selftest
