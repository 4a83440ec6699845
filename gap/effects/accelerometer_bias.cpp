#include "gap/effects/list.h"

namespace puckloop::gap {

Effect accelerometer_bias() {
    return {
        .name = "accelerometer_bias",
        .number = 39,
        .title = "the accelerometer has another zero",
        .mechanism = "Parts differ; the boot calibration took a tilt for level.",
        .equation = "zero + b",
        .kinds = {Kind::Accelerometer},
        .parameters =
            {{"accelerometer.bias*", -900.0, 900.0, 60.0, {}, "accX -223 against -17 between sessions"}},
        .needs = {},
        .observables = "each axis",
        .enters = "accelerometer.bias",
        .confounded = {"accelerometer_session"},
        .separated_by = "turn the robot upside down",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
