// The microphones.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> microphone_effects() {
    return {
        {
            .name = "microphone_gain",
            .number = 41,
            .title = "the microphones have different gains",
            .mechanism = "Parts and housings differ.",
            .equation = "level_m = g_m level",
            .kinds = {Kind::Microphone},
            .parameters = {{"microphone.gain*", 0.1, 5.0, 0.2, {}, "+-8 %"}},
            .observables = "all levels of a microphone",
            .enters = "microphone.gain",
            .confounded = {"microphone_window"},
            .separated_by = "one sound on the axis of each microphone in turn",
        },
        {
            .name = "microphone_self_noise",
            .number = 41,
            .title = "the microphones hear the robot itself",
            .mechanism = "Amplifier noise and motors set a floor.",
            .equation = "level + n + m |v| / 1000",
            .kinds = {Kind::Microphone},
            .parameters = {{"microphone.self_noise", -20.0, 300.0, 15.0, {}, "idle 8-10 counts"},
                           {"microphone.motor_noise", -20.0, 300.0, 15.0, {}, "9-15 with motors"}},
            .observables = "weak levels",
            .enters = "microphone.self_noise, microphone.motor_noise",
            .confounded = {"microphone_fall"},
            .separated_by = "silence, with motors on and off",
            .role = EffectRole::Scatter,
        },
        {
            .name = "microphone_fall",
            .number = 41,
            .title = "sound falls with distance by another law",
            .mechanism = "Walls reflect; the field is not free.",
            .equation = "level ~ d^-p",
            .kinds = {Kind::Microphone},
            .parameters = {{"microphone.exponent", 0.2, 2.5, 0.2, {}, "p 1.16 in a room"}},
            .observables = "the shape over distance",
            .enters = "microphone.exponent",
            .confounded = {"microphone_self_noise"},
            .separated_by = "distances over a decade, outdoors and in a room",
        },
        {
            .name = "microphone_directivity",
            .number = 41,
            .title = "the microphones hear better from one side",
            .mechanism = "Housing and body shade the sound.",
            .equation = "level (1 + D cos(angle))",
            .kinds = {Kind::Microphone},
            .parameters = {{"microphone.directivity", -0.5, 1.5, 0.2, {}, "D 0.3"}},
            .needs = {"angle_rad"},
            .observables = "levels over direction",
            .enters = "microphone.directivity",
            .confounded = {"microphone_gain"},
            .separated_by = "turn the robot before a steady sound",
        },
        {
            .name = "microphone_window",
            .number = 42,
            .title = "the level is taken from fewer samples",
            .mechanism = "Largest minus smallest of a window grows with its length.",
            .equation = "level ~ sqrt(ln N)",
            .kinds = {Kind::Microphone},
            .parameters = {{"microphone.window_lost", -0.5, 0.97, 0.3, {0.3}, "level ~ sqrt(2 ln N)"}},
            .needs = {"window"},
            .observables = "levels, by window length",
            .enters = "microphone.window_lost: samples that the board holds",
            .confounded = {"microphone_gain"},
            .separated_by = "two window lengths on the same sound",
        },
    };
}

}  // namespace puckloop::gap
