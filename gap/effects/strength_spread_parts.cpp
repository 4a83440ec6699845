#include "gap/effects/list.h"

namespace puckloop::gap {

Effect strength_spread_parts() {
    return {
        .name = "strength_spread_parts",
        .number = 46,
        .title = "emitters and receivers differ in gain",
        .mechanism = "Parts and soldering.",
        .equation = "s_ij = g_i g_j s",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.receiver_gain*", 0.2, 4.0, 0.25, {}, "log-normal 0.1..0.3"},
                       {"rab.emitter_gain*", 0.2, 4.0, 0.25, {}, "as receivers"}},
        .needs = {},
        .observables = "strength by receiver, bearing",
        .enters = "ir.receiver_gain, ir.emitter_gain",
        .confounded = {"range_noise"},
        .separated_by = "turn the receiver before one fixed emitter, with several pairs of boards",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
