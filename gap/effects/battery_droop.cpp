#include "gap/effects/list.h"

namespace puckloop::gap {

Effect battery_droop() {
    return {
        .name = "battery_droop",
        .number = 64,
        .title = "readings follow the battery",
        .mechanism = "Emitter current falls with the voltage.",
        .equation = "y (1 + k (V - mean))",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.battery_gain", -1.0, 1.0, 0.15, {}, "?"}},
        .needs = {"battery_v"},
        .observables = "all readings, slowly",
        .enters = "proximity.battery_gain",
        .confounded = {"warm_up", "slow_drift"},
        .separated_by = "the same with a full and an empty battery",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
