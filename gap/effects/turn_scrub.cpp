#include "gap/effects/list.h"

namespace puckloop::gap {

Effect turn_scrub() {
    return {
        .name = "turn_scrub",
        .number = 4,
        .title = "tyres scrub in tight turns",
        .mechanism = "A tyre of finite width has a wandering point of contact: the tighter the turn, the "
                     "longer the axle acts.",
        .equation = "L_eff = L (1 + c |w| L/2 / (|v| + |w| L/2))",
        .kinds = {Kind::Motion},
        .parameters = {{"robot.turn_scrub",
                        -0.05,
                        3.0,
                        0.04,
                        {},
                        "0..4 % between circle and spot turn; measured 0.7 % on another robot"}},
        .needs = {},
        .observables = "heading",
        .enters = "robot.turn_scrub (physics/floor_motion)",
        .confounded = {"axle_length"},
        .separated_by = "spot turns beside wide circles of the same angle",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
