// The microphones.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> microphone_effects() {
    return {
        // Parts and housings differ. level_m = g_m level
        {
            .name = "microphone_gain",
            .number = 41,
            .title = "the microphones have different gains",
            .parameters = {{"microphone.gain*", 0.1, 5.0, 0.2, "+-8 %"}},
            .enters = "microphone.gain",
            .separated_by = "one sound on the axis of each microphone in turn",
        },
        // Amplifier noise and motors set a floor. level + n + m |v| / 1000
        {
            .name = "microphone_self_noise",
            .number = 41,
            .title = "the microphones hear the robot itself",
            .parameters = {{"microphone.self_noise", -20.0, 300.0, 15.0, "idle 8-10 counts"},
                           {"microphone.motor_noise", -20.0, 300.0, 15.0, "9-15 with motors"}},
            .enters = "microphone.self_noise, microphone.motor_noise",
            .separated_by = "silence, with motors on and off",
            .role = EffectRole::Scatter,
        },
        // Walls reflect; the field is not free. level ~ d^-p
        {
            .name = "microphone_fall",
            .number = 41,
            .title = "sound falls with distance by another law",
            .parameters = {{"microphone.exponent", 0.2, 2.5, 0.2, "p 1.16 in a room"}},
            .enters = "microphone.exponent",
            .separated_by = "distances over a decade, outdoors and in a room",
        },
        // Housing and body shade the sound. level (1 + D cos(angle))
        {
            .name = "microphone_directivity",
            .number = 41,
            .title = "the microphones hear better from one side",
            .parameters = {{"microphone.directivity", -0.5, 1.5, 0.2, "D 0.3"}},
            .needs = {"angle_rad"},
            .enters = "microphone.directivity",
            .separated_by = "turn the robot before a steady sound",
        },
        // Largest minus smallest of a window grows with its length. level ~ sqrt(ln N)
        {
            .name = "microphone_window",
            .number = 42,
            .title = "the level is taken from fewer samples",
            .parameters = {{"microphone.window_lost", -0.5, 0.97, 0.3, "level ~ sqrt(2 ln N)", {0.3}}},
            .needs = {"window"},
            .enters = "microphone.window_lost: samples that the board holds",
            .separated_by = "two window lengths on the same sound",
        },
    };
}

}  // namespace puckloop::gap
