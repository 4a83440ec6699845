#include "gap/effects/list.h"

namespace puckloop::gap {

Effect microphone_self_noise() {
    return {
        .name = "microphone_self_noise",
        .number = 41,
        .title = "the microphones hear the robot itself",
        .mechanism = "Amplifier noise and motors set a floor.",
        .equation = "level + n + m |v| / 1000",
        .kinds = {Kind::Microphone},
        .parameters = {{"microphone.self_noise", -20.0, 300.0, 15.0, {}, "idle 8-10 counts"},
                       {"microphone.motor_noise", -20.0, 300.0, 15.0, {}, "9-15 with motors"}},
        .needs = {},
        .observables = "weak levels",
        .enters = "microphone.self_noise, microphone.motor_noise",
        .confounded = {"microphone_fall"},
        .separated_by = "silence, with motors on and off",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
