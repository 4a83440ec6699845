#include "gap/effects/list.h"

namespace puckloop::gap {

Effect warm_up() {
    return {
        .name = "warm_up",
        .number = 33,
        .title = "the readings drift while the robot warms up",
        .mechanism = "Temperature changes emitters and amplifiers over minutes.",
        .equation = "y (1 + k (1 - exp(-t / T)))",
        .kinds = {Kind::Proximity, Kind::Microphone, Kind::Ground, Kind::Accelerometer},
        .parameters = {{"proximity.warmup_gain", -0.6, 0.6, 0.08, {}, "k -.1..+.1"},
                       {"proximity.warmup_time", 20.0, 2000.0, 250.0, {}, "T 2..10 min"},
                       {"microphone.warmup_gain", -0.8, 0.8, 0.1, {}, "mean rose 290 to 316 in 60 s"},
                       {"microphone.warmup_time", 20.0, 2000.0, 250.0, {}, "?"},
                       {"ground.warmup_gain", -0.6, 0.6, 0.08, {}, "-67..-114 counts in 200 s"},
                       {"ground.warmup_time", 20.0, 2000.0, 250.0, {}, "?"},
                       {"accelerometer.warmup", -500.0, 500.0, 40.0, {}, "?"},
                       {"accelerometer.warmup_time", 20.0, 2000.0, 250.0, {}, "?"}},
        .needs = {"t_s"},
        .observables = "everything, slowly",
        .enters = "proximity.warmup_gain, proximity.warmup_time, microphone.warmup_gain, "
                  "microphone.warmup_time, ground.warmup_gain, "
                  "ground.warmup_time, accelerometer.warmup, accelerometer.warmup_time",
        .confounded = {"slow_drift", "battery_droop"},
        .separated_by = "random order of distances, and the first one again at the end",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
