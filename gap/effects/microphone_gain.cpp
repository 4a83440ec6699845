#include "gap/effects/list.h"

namespace puckloop::gap {

Effect microphone_gain() {
    return {
        .name = "microphone_gain",
        .number = 41,
        .title = "the microphones have different gains",
        .mechanism = "Parts and housings differ.",
        .equation = "level_m = g_m level",
        .kinds = {Kind::Microphone},
        .parameters = {{"microphone.gain*", 0.1, 5.0, 0.2, {}, "+-8 %"}},
        .needs = {},
        .observables = "all levels of a microphone",
        .enters = "microphone.gain",
        .confounded = {"microphone_window"},
        .separated_by = "one sound on the axis of each microphone in turn",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
