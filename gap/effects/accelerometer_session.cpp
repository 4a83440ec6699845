#include "gap/effects/list.h"

namespace puckloop::gap {

Effect accelerometer_session() {
    return {
        .name = "accelerometer_session",
        .number = 39,
        .title = "the accelerometer's zero jumps between sessions",
        .mechanism = "It is calibrated at power-up, on whatever the robot stands.",
        .equation = "zero + b_session",
        .kinds = {Kind::Accelerometer},
        .parameters = {{"accelerometer.session_bias*",
                        -900.0,
                        900.0,
                        80.0,
                        {},
                        "accX -223 against -17, gyroX -41 against -577"}},
        .needs = {"session"},
        .observables = "each axis, constant inside a session",
        .enters = "accelerometer.session_spread: each run draws its own zero; accelerometer.bias",
        .confounded = {"warm_up"},
        .separated_by = "switch the robot off and on where it stands",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
