#include "gap/effects/list.h"

namespace puckloop::gap {

Effect sensor_offset() {
    return {
        .name = "sensor_offset",
        .number = 19,
        .title = "the sensors have other offsets",
        .mechanism = "The idle reading differs from the calibrated one and drifts with temperature.",
        .equation = "y_i = f(d) + o_i",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.offset*", -500.0, 1000.0, 40.0, {}, "-20..+40 counts"}},
        .needs = {},
        .observables = "all readings of a sensor, most visible far away",
        .enters = "proximity.offset",
        .confounded = {"ambient_light", "sensor_gain"},
        .separated_by = "readings with nothing in reach, in the dark",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
