#include "gap/effects/list.h"

namespace puckloop::gap {

Effect saturation() {
    return {
        .name = "saturation",
        .number = 21,
        .title = "the answer is compressed near contact",
        .mechanism = "The receiver nears its rail: counts grow slower than light.",
        .equation = "y = 1 / (1/S + 1/f(d))",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.compression", 0.0, 0.001, 0.00015, {0.0001}, "S 3500..5000 counts"},
                       {"proximity.saturation", 800.0, 10000.0, 1500.0, {3000.0}, "S 3500..5000 counts"}},
        .needs = {},
        .observables = "readings near contact",
        .enters = "proximity.compression (any curve), proximity.saturation (curves 1 and 2)",
        .confounded = {"response_law"},
        .separated_by = "distances below 1 cm in steps of 1 mm",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
