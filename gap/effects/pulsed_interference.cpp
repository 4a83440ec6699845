#include "gap/effects/list.h"

namespace puckloop::gap {

Effect pulsed_interference() {
    return {
        .name = "pulsed_interference",
        .number = 24,
        .title = "another pulsed source hits the samples",
        .mechanism = "A range finder, another robot's emitters or a range-and-bearing board falls on the "
                     "dark or the lit sample.",
        .equation = "with probability q: y +- c",
        .kinds = {Kind::Proximity},
        .parameters =
            {{"proximity.interference_rate", 0.0, 0.6, 0.08, {0.05}, "q 0.02..0.2"},
             {"proximity.interference_size", 5.0, 2000.0, 200.0, {100.0}, "tens to hundreds of counts"}},
        .needs = {},
        .observables = "two-sided outliers",
        .enters = "proximity.interference_rate, proximity.interference_size; proximity.interference_share of "
                  "sensors that the data shows sheltered",
        .confounded = {"proportional_noise"},
        .separated_by = "the same with the other robots switched off",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
