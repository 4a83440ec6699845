#include "gap/effects/list.h"

namespace puckloop::gap {

Effect proportional_noise() {
    return {
        .name = "proportional_noise",
        .number = 35,
        .title = "noise grows with the reading",
        .mechanism = "Gain noise beside the converter's.",
        .equation = "sd = sqrt(a^2 + (b y)^2)",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.proportional_noise",
                        0.0,
                        0.6,
                        0.03,
                        {0.01},
                        "b 0.2-5 % in a published table, about 0 measured"}},
        .needs = {},
        .observables = "scatter near contact",
        .enters = "proximity.proportional_noise",
        .confounded = {"motor_noise"},
        .separated_by = "many repeats at several distances",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
