#include "gap/effects/list.h"

namespace puckloop::gap {

Effect microphone_window() {
    return {
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
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
