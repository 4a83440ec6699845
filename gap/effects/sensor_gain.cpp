#include "gap/effects/list.h"

namespace puckloop::gap {

Effect sensor_gain() {
    return {
        .name = "sensor_gain",
        .number = 18,
        .title = "the sensors have different gains",
        .mechanism = "Emitters, receivers and their alignment differ from part to part.",
        .equation = "y_i = g_i f(d)",
        .kinds = {Kind::Proximity},
        .parameters =
            {{"proximity.gain*", 0.05, 5.0, 0.3, {}, "log-normal spread 0.15..0.35; ps0 / ps7 1.08..1.65"}},
        .needs = {},
        .observables = "all readings of a sensor, in proportion",
        .enters = "proximity.gain",
        .confounded = {"reflectivity", "sensor_offset"},
        .separated_by = "all sensors before the same white wall, and two different surfaces",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
