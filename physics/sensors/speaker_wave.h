#pragma once
// What a scenario's loudspeaker plays, and when: steady noise known by its level only (sound.h), or a wave
// that travels (sound_waves.h): a tone, a sweep, or noise.

#include "physics/description/description.h"

#include <cstdint>
#include <optional>

namespace puckloop::physics {

/// It plays a wave: its sound reaches microphones with delay and phase, not as a level.
inline bool is_wave(const Speaker& speaker) {
    return speaker.wave || speaker.tone > 0.0;
}

/// Seconds since the sound that it plays at `seconds` began; nothing while it is silent.
std::optional<double> into_sound(const Speaker& speaker, double seconds);
/// Does it play at any time from `from` to `until`?
bool plays_within(const Speaker& speaker, double from, double until);

/// Of a wave: -1..1 at `seconds`, 0 while it is silent. Noise is white up to 8 kHz, evenly spread, of the
/// world's `seed` and the loudspeaker's name.
double wave_of(const Speaker& speaker, std::uint64_t seed, double seconds);

}  // namespace puckloop::physics
