#include "gap/effects/list.h"

namespace puckloop::gap {

Effect ground_lag() {
    return {
        .name = "ground_lag",
        .number = 38,
        .title = "the ground sensors answer late",
        .mechanism = "Sampling and transport hold the reading back.",
        .equation = "grey where the robot was tau ago",
        .kinds = {Kind::Ground},
        .parameters = {{"ground.lag", -0.05, 1.0, 0.1, {}, "18 of 37 samples of pitch"}},
        .needs = {"grey_rate"},
        .observables = "readings where the grey changes, in proportion to speed",
        .enters = "ground.lag, less the emulated board's and host's own share",
        .confounded = {"ground_position"},
        .separated_by = "an edge crossed at two speeds and in both directions",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
