#include "gap/effects/list.h"

namespace puckloop::gap {

Effect truncation() {
    return {
        .name = "truncation",
        .number = 60,
        .title = "frames are cut now and then",
        .mechanism = "Radio or line drop-outs, in bursts.",
        .equation = "p, in bursts",
        .kinds = {Kind::Timing},
        .parameters = {{"timing.truncation", 0.0, 0.5, 0.02, {0.005}, "1e-4..1e-2"},
                       {"timing.truncation_burst", 0.0, 0.98, 0.4, {0.3}, "bursts"}},
        .needs = {},
        .observables = "frames wrong whatever they hold",
        .enters = "the overlay's [uart] answer_cut, answer_cut_again",
        .confounded = {"baud_mismatch"},
        .separated_by = "the same frames over a cable",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
