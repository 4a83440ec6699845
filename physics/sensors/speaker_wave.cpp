#include "physics/sensors/speaker_wave.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puckloop::physics {

namespace {

constexpr double kNoiseRate = 16000.0;  // Hz

/// Even bits of a number and a seed (splitmix64, Vigna).
std::uint64_t scattered(std::uint64_t value) {
    value += 0x9E3779B97F4A7C15u;
    value = (value ^ value >> 30) * 0xBF58476D1CE4E5B9u;
    value = (value ^ value >> 27) * 0x94D049BB133111EBu;
    return value ^ value >> 31;
}

std::uint64_t stream_of(const Speaker& speaker, std::uint64_t seed) {
    std::uint64_t stream = scattered(seed);
    for (const char letter : speaker.name)
        stream = scattered(stream ^ static_cast<unsigned char>(letter));
    return stream;
}

double noise(std::uint64_t stream, double sample) {
    constexpr double kHalf = 0x1p63;
    return static_cast<double>(scattered(stream ^ static_cast<std::uint64_t>(sample))) / kHalf - 1.0;
}

/// Number of the sound that has begun last, -1 before the first.
double last_begun(const Speaker& speaker, double seconds) {
    if (seconds < speaker.on) return -1.0;
    if (!(speaker.every > 0.0)) return 0.0;
    const double number = std::floor((seconds - speaker.on) / speaker.every);
    return speaker.times > 0 ? std::min(number, static_cast<double>(speaker.times - 1)) : number;
}

}  // namespace

std::optional<double> into_sound(const Speaker& speaker, double seconds) {
    const double number = last_begun(speaker, seconds);
    if (number < 0.0) return std::nullopt;
    const double into = seconds - speaker.on - number * speaker.every;
    if (into < speaker.off - speaker.on) return into;
    return std::nullopt;
}

bool plays_within(const Speaker& speaker, double from, double until) {
    const double number = last_begun(speaker, until);
    return number >= 0.0 && speaker.off + number * speaker.every > from;
}

double wave_of(const Speaker& speaker, std::uint64_t seed, double seconds) {
    const std::optional<double> into = into_sound(speaker, seconds);
    if (!into) return 0.0;
    if (speaker.tone > 0.0) {
        double turns = speaker.tone * *into;
        if (speaker.sweep_to > 0.0)
            turns += (speaker.sweep_to - speaker.tone) * *into * *into / (2 * (speaker.off - speaker.on));
        return std::sin(2 * std::numbers::pi * turns);
    }
    const std::uint64_t stream = stream_of(speaker, seed);
    const double at = seconds * kNoiseRate, whole = std::floor(at);
    const double before = noise(stream, whole), after = noise(stream, whole + 1.0);
    return before + (after - before) * (at - whole);
}

}  // namespace puckloop::physics
