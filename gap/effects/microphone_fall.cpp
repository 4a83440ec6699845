#include "gap/effects/list.h"

namespace puckloop::gap {

Effect microphone_fall() {
    return {
        .name = "microphone_fall",
        .number = 41,
        .title = "sound falls with distance by another law",
        .mechanism = "Walls reflect; the field is not free.",
        .equation = "level ~ d^-p",
        .kinds = {Kind::Microphone},
        .parameters = {{"microphone.exponent", 0.2, 2.5, 0.2, {}, "p 1.16 in a room"}},
        .needs = {},
        .observables = "the shape over distance",
        .enters = "microphone.exponent",
        .confounded = {"microphone_self_noise"},
        .separated_by = "distances over a decade, outdoors and in a room",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
