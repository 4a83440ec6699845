#include "gap/effects/list.h"

namespace puckloop::gap {

Effect response_law() {
    return {
        .name = "response_law",
        .number = 20,
        .title = "the answer falls with distance by another law",
        .mechanism =
            "The effective origin and the exponent of the reflective response differ from the assumed curve.",
        .equation = "A / (d + d0)^p",
        .kinds = {Kind::Proximity},
        .parameters =
            {{"proximity.extra_exponent", -1.4, 1.4, 0.3, {}, "p 1.5..2.5"},
             {"proximity.distance_shift", -0.004, 0.02, 0.003, {}, "d0 3..10 mm"},
             {"proximity.exponent", 0.8, 3.8, 0.4, {}, "p 1.5..2.5"},
             {"proximity.origin", 0.001, 0.03, 0.004, {}, "d0 3..10 mm"},
             {"proximity.amplitude", 1e3, 1e7, 6e5, {}, "A 1.2e5..4.2e5, varies with p"},
             {"proximity.scale", 0.2, 4.0, 0.3, {}, "A varies by 2 between robots", "proximity.amplitude"}},
        .needs = {},
        .observables = "the shape over distance",
        .enters = "proximity.exponent, origin, amplitude; extra_exponent, distance_shift and scale on the "
                  "measured table",
        .confounded = {"saturation", "sensor_gain"},
        .separated_by = "distances over two decades of counts, saturated and floor readings included",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
