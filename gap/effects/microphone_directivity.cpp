#include "gap/effects/list.h"

namespace puckloop::gap {

Effect microphone_directivity() {
    return {
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
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
