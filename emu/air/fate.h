#pragma once
// What becomes of a frame at a station that it was meant for, and the account of it.

#include <array>
#include <cstddef>
#include <cstdint>

namespace puckloop::air {

enum class Fate : std::uint8_t {
    Read,
    Weak,       ///< too little power arrives
    Noise,      ///< spoilt by noise
    Collision,  ///< by another frame
    Sending,    ///< the station sent itself
    Away,       ///< it was away
};

inline const char* name_of(Fate fate) {
    constexpr std::array kNames{"read", "weak", "noise", "collision", "sending", "away"};
    return kNames[static_cast<std::size_t>(fate)];
}

/// Frames meant for a station that it did not read.
struct Losses {
    std::uint64_t weak = 0, noise = 0, collisions = 0, sending = 0, away = 0;

    void count(Fate fate) {
        switch (fate) {
        case Fate::Read:
            break;
        case Fate::Weak:
            ++weak;
            break;
        case Fate::Noise:
            ++noise;
            break;
        case Fate::Collision:
            ++collisions;
            break;
        case Fate::Sending:
            ++sending;
            break;
        case Fate::Away:
            ++away;
            break;
        }
    }
};

}  // namespace puckloop::air
