// The accelerometer.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> accelerometer_effects() {
    return {
        {
            .name = "accelerometer_bias",
            .number = 39,
            .title = "the accelerometer has another zero",
            .mechanism = "Parts differ; the boot calibration took a tilt for level.",
            .equation = "zero + b",
            .kinds = {Kind::Accelerometer},
            .parameters =
                {{"accelerometer.bias*", -900.0, 900.0, 60.0, {}, "accX -223 against -17 between sessions"}},
            .observables = "each axis",
            .enters = "accelerometer.bias",
            .confounded = {"accelerometer_session"},
            .separated_by = "turn the robot upside down",
        },
        {
            .name = "accelerometer_scale",
            .number = 39,
            .title = "the accelerometer's scale or axes are off",
            .mechanism = "Sensitivity differs by axis; the chip is turned on its board.",
            .equation = "gain_i R(turn) a",
            .kinds = {Kind::Accelerometer},
            .parameters = {{"accelerometer.scale*", 0.5, 1.6, 0.06, {}, "744-800 counts a g"},
                           {"accelerometer.turn", -0.6, 0.6, 0.1, {}, "?"}},
            .observables = "each axis, in proportion",
            .enters = "accelerometer.scale, accelerometer.turn",
            .confounded = {"accelerometer_bias"},
            .separated_by = "all six faces down",
        },
        {
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
            .enters = "measuring chain: the sessions; a scenario's run has their mean (accelerometer.bias)",
            .confounded = {"warm_up"},
            .separated_by = "switch the robot off and on where it stands",
        },
        {
            .name = "vibration",
            .number = 40,
            .title = "driving shakes the accelerometer",
            .mechanism = "Stepping motors and gears.",
            .equation = "sd^2 + (k v)^2",
            .kinds = {Kind::Accelerometer},
            .parameters =
                {{"accelerometer.vibration", 0.0, 1000.0, 60.0, {15.0}, "gyroZ sd 640 while driving"}},
            .needs = {"motor_speed"},
            .observables = "scatter while driving",
            .enters = "accelerometer.vibration",
            .confounded = {"reference_sag"},
            .separated_by = "wheels in the air at several speeds",
            .role = EffectRole::Scatter,
        },
    };
}

}  // namespace puckloop::gap
