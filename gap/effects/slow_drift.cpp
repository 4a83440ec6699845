#include "gap/effects/list.h"

namespace puckloop::gap {

Effect slow_drift() {
    return {
        .name = "slow_drift",
        .number = 66,
        .title = "the world changes between the runs",
        .mechanism = "Daylight, people, dust: later runs differ from earlier ones. At which of them the "
                     "simulator was right nobody knows.",
        .equation = "y (1 + k (order - order0))",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.order_drift", -0.2, 0.2, 0.02, {}, "?"},
                       {"proximity.order_zero",
                        -2.0,
                        2.0,
                        0.5,
                        {},
                        "order0 from the rows' mean, in halves of the runs' range: within it, or soon before "
                        "or after"}},
        .needs = {"order"},
        .observables = "all readings, run by run",
        .enters = "proximity.order_drift; proximity.order is the run's place in a series",
        .confounded = {"warm_up", "battery_droop"},
        .separated_by = "random order over several days",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
