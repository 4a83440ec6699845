#include "gap/effects/list.h"

namespace puckloop::gap {

Effect ground_height() {
    return {
        .name = "ground_height",
        .number = 37,
        .title = "the board's height or tilt changes the readings",
        .mechanism = "The nose lifts when the robot accelerates; or the board sits higher than drawn.",
        .equation = "signal (1 - s lift)",
        .kinds = {Kind::Ground},
        .parameters = {{"ground.acceleration_tilt", -1.0, 1.0, 0.05, {}, "correlates with acceleration"},
                       {"ground.raised", -0.01, 0.01, 0.002, {}, "1-2 mm"}},
        .needs = {"acceleration"},
        .observables = "readings at starts and stops",
        .enters = "ground.height, ground.acceleration_tilt",
        .confounded = {"ground_gain"},
        .separated_by = "starts and stops on one plain grey",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
