#include "gap/effects/list.h"

namespace puckloop::gap {

Effect slow_drift() {
    return {
        .name = "slow_drift",
        .number = 66,
        .title = "the world changes between the runs",
        .mechanism = "Daylight, people, dust: later runs differ from earlier ones.",
        .equation = "y (1 + k order)",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.order_drift", -0.2, 0.2, 0.02, {}, "?"}},
        .needs = {"order"},
        .observables = "all readings, run by run",
        .enters = "none: repeat the session",
        .confounded = {"warm_up", "battery_droop"},
        .separated_by = "random order over several days",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
