#include "gap/effects/list.h"

namespace puckloop::gap {

Effect dead_zone() {
    return {
        .name = "dead_zone",
        .number = 34,
        .title = "weak readings are cut to zero",
        .mechanism = "A threshold in the sensor or its software.",
        .equation = "y = 0 where y < theta",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.threshold", 1.0, 2500.0, 150.0, {}, "1060 on another robot"}},
        .needs = {},
        .observables = "readings near the floor",
        .enters = "proximity.threshold",
        .confounded = {"sensor_offset"},
        .separated_by = "distances in small steps where the reading vanishes",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
