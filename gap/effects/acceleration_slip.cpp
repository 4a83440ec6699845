#include "gap/effects/list.h"

namespace puckloop::gap {

Effect acceleration_slip() {
    return {
        .name = "acceleration_slip",
        .number = 5,
        .title = "wheels slip more or less than assumed when the speed jumps",
        .mechanism =
            "Friction limits acceleration: a jump of speed costs way at starts and gives some at stops.",
        .equation = "lost = (change of speed)^2 / (2 mu g) at each jump",
        .kinds = {Kind::Motion},
        .parameters = {{"inverse_friction",
                        0.0,
                        60.0,
                        6.0,
                        {8.0, 25.0},
                        "mu 0.05..0.8: 17..1 mm for a jump to 12.9 cm/s; 0: they follow at once, or speeds "
                        "do not jump"}},
        .needs = {},
        .observables = "way along, heading",
        .enters = "contact.mu and contact.mu_lateral",
        .confounded = {"backlash", "tracker_delay"},
        .separated_by = "the same distance in one hop and in ten",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
