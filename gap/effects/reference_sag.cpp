#include "gap/effects/list.h"

namespace puckloop::gap {

Effect reference_sag() {
    return {
        .name = "reference_sag",
        .number = 31,
        .title = "the converter's reference sags under load",
        .mechanism = "Motor current pulls the reference: all channels shrink together.",
        .equation = "y (1 - r) with motors on",
        .kinds = {Kind::Proximity, Kind::Accelerometer},
        .parameters = {{"proximity.motor_sag", -0.05, 0.3, 0.015, {}, "r 0..2 %"},
                       {"accelerometer.motor_sag", -0.05, 0.3, 0.015, {}, "r 0..2 %"}},
        .needs = {"motor_speed"},
        .observables = "all channels at once, accelerometer zero included",
        .enters = "proximity.motor_sag, accelerometer.motor_sag",
        .confounded = {"reflectivity"},
        .separated_by = "all channels, with motors on and off at the same place",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
