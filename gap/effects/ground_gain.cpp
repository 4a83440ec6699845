#include "gap/effects/list.h"

namespace puckloop::gap {

Effect ground_gain() {
    return {
        .name = "ground_gain",
        .number = 36,
        .title = "the ground sensors have other gains and offsets",
        .mechanism = "Parts and their height differ from robot to robot.",
        .equation = "y = o_i + g_i f(grey)",
        .kinds = {Kind::Ground},
        .parameters = {{"ground.gain*", 0.1, 3.0, 0.2, {}, "black 81..677 between 30 robots"},
                       {"ground.offset*", -500.0, 500.0, 60.0, {}, "as gain"}},
        .needs = {},
        .observables = "all readings of a sensor",
        .enters = "ground.gain, ground.offset",
        .confounded = {"ground_height"},
        .separated_by = "black and white paper under each sensor",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
