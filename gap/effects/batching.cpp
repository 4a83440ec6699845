#include "gap/effects/list.h"

namespace puckloop::gap {

Effect batching() {
    return {
        .name = "batching",
        .number = 63,
        .title = "the host hands frames over in batches",
        .mechanism = "Radio and operating system deliver at their own ticks.",
        .equation = "t_host = ceil(t / B) B",
        .kinds = {Kind::Timing},
        .parameters = {{"timing.batch",
                        0.002,
                        1.0,
                        0.001,
                        {0.02},
                        "ticks of 5..50 ms; intervals bimodal",
                        nullptr,
                        1e-6}},
        .needs = {},
        .observables = "arrival: intervals of 0 and more than a period",
        .enters = "the overlay's [linux] tty_batch",
        .confounded = {"i2c_stretch"},
        .separated_by = "log the robot's own clock",
        .measuring_chain = true,
    };
}

}  // namespace puckloop::gap
