#include "gap/effects/list.h"

namespace puckloop::gap {

Effect ground_position() {
    return {
        .name = "ground_position",
        .number = 38,
        .title = "the ground sensors stand elsewhere than drawn",
        .mechanism = "The board is mounted further ahead or aside.",
        .equation = "grey at x + dx",
        .kinds = {Kind::Ground},
        .parameters = {{"ground.forward_error", -0.05, 0.05, 0.005, {}, "edges shift with heading"},
                       {"ground.left_error", -0.02, 0.02, 0.004, {}, "?"}},
        .needs = {"grey_rate"},
        .observables = "readings where the grey changes",
        .enters = "ground.x, ground.y",
        .confounded = {"ground_lag"},
        .separated_by = "an edge crossed at two speeds and in both directions",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
