// The accelerometer.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> accelerometer_effects() {
    return {
        // Parts differ; the boot calibration took a tilt for level. zero + b
        {
            .name = "accelerometer_bias",
            .number = 39,
            .title = "the accelerometer has another zero",
            .parameters = {{"accelerometer.bias*", -900.0, 900.0, 60.0,
                            "accX -223 against -17 between sessions"}},
            .enters = "accelerometer.bias",
            .separated_by = "turn the robot upside down",
        },
        // Sensitivity differs by axis; the chip is turned on its board. gain_i R(turn) a
        {
            .name = "accelerometer_scale",
            .number = 39,
            .title = "the accelerometer's scale or axes are off",
            .parameters = {{"accelerometer.scale*", 0.5, 1.6, 0.06, "744-800 counts a g"},
                           {"accelerometer.turn", -0.6, 0.6, 0.1, "?"}},
            .enters = "accelerometer.scale, accelerometer.turn",
            .separated_by = "all six faces down",
        },
        // It is calibrated at power-up, on whatever the robot stands. zero + b_session
        {
            .name = "accelerometer_session",
            .number = 39,
            .title = "the accelerometer's zero jumps between sessions",
            .parameters = {{"accelerometer.session_bias*", -900.0, 900.0, 80.0,
                            "accX -223 against -17, gyroX -41 against -577"}},
            .needs = {"session"},
            .enters = "measuring chain: the sessions; a scenario's run has their mean (accelerometer.bias)",
            .separated_by = "switch the robot off and on where it stands",
        },
        // Stepping motors and gears. sd^2 + (k v)^2
        {
            .name = "vibration",
            .number = 40,
            .title = "driving shakes the accelerometer",
            .parameters =
                {{"accelerometer.vibration", 0.0, 1000.0, 60.0, "gyroZ sd 640 while driving", {15.0}}},
            .needs = {"motor_speed"},
            .enters = "accelerometer.vibration",
            .separated_by = "wheels in the air at several speeds",
            .role = EffectRole::Scatter,
        },
    };
}

}  // namespace puckloop::gap
