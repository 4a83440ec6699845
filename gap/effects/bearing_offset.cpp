#include "gap/effects/list.h"

namespace puckloop::gap {

Effect bearing_offset() {
    return {
        .name = "bearing_offset",
        .number = 15,
        .title = "bearings are off by a constant",
        .mechanism = "The receiver or the truth's axis is turned.",
        .equation = "bearing + b",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.bearing_offset", -1.5, 1.5, 0.1, {}, "-2..+8 degrees"}},
        .needs = {},
        .observables = "bearing",
        .enters = "ir.receiver_angle",
        .confounded = {"strength_spread_parts"},
        .separated_by = "the sender moved round the receiver",
        .measuring_chain = true,
    };
}

}  // namespace puckloop::gap
