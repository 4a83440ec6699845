#include "gap/effects/list.h"

namespace puckloop::gap {

Effect vibration() {
    return {
        .name = "vibration",
        .number = 40,
        .title = "driving shakes the accelerometer",
        .mechanism = "Stepping motors and gears.",
        .equation = "sd^2 + (k v)^2",
        .kinds = {Kind::Accelerometer},
        .parameters = {{"accelerometer.vibration", 0.0, 1000.0, 60.0, {15.0}, "gyroZ sd 640 while driving"}},
        .needs = {"motor_speed"},
        .observables = "scatter while driving",
        .enters = "accelerometer.vibration",
        .confounded = {"reference_sag"},
        .separated_by = "wheels in the air at several speeds",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
