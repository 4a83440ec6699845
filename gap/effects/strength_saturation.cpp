#include "gap/effects/list.h"

namespace puckloop::gap {

Effect strength_saturation() {
    return {
        .name = "strength_saturation",
        .number = 49,
        .title = "near strengths are clipped early",
        .mechanism = "The peak detector reaches its rail.",
        .equation = "s = min(s, S)",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.saturation", 300.0, 4095.0, 1500.0, {}, "4095; readings fold below 2 cm"}},
        .needs = {},
        .observables = "strength at small distance",
        .enters = "ir.rail",
        .confounded = {"far_floor"},
        .separated_by = "distances below 5 cm",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
