#include "gap/effects/list.h"

namespace puckloop::gap {

Effect stale_readings() {
    return {
        .name = "stale_readings",
        .number = 32,
        .title = "readings are older than they look",
        .mechanism = "Sampling schedule and host hold values back.",
        .equation = "y(t) belongs to t - tau",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.age", -0.02, 0.5, 0.03, {}, "0..15.9 ms plus the host's hold"}},
        .needs = {"velocity"},
        .observables = "readings while the distance changes",
        .enters = "proximity.age, less the emulated schedule's own share",
        .confounded = {"response_law"},
        .separated_by = "approach and retreat at the same speed",
        .measuring_chain = true,
    };
}

}  // namespace puckloop::gap
