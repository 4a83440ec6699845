#include "gap/effects/list.h"

namespace puckloop::gap {

Effect long_period() {
    return {
        .name = "long_period",
        .number = 61,
        .title = "the control loop takes longer than nominal",
        .mechanism = "Bytes and delays add to the nominal period.",
        .equation = "T = T0 + delta, with jitter",
        .kinds = {Kind::Timing},
        .parameters = {{"timing.extra_period", -0.05, 0.2, 0.004, {0.004, -0.004}, "104 ms typical"},
                       {"timing.period_jitter", 0.0, 0.2, 0.003, {0.0005}, "1..5 ms"}},
        .needs = {},
        .observables = "robot's clock against the number of periods",
        .enters =
            "the overlay's [linux] oversleep, oversleep_jitter, beside what emerges from the emulated loop",
        .confounded = {"clock_drift"},
        .separated_by = "count periods against a second clock",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
