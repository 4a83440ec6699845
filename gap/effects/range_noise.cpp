#include "gap/effects/list.h"

namespace puckloop::gap {

Effect range_noise() {
    return {
        .name = "range_noise",
        .number = 47,
        .title = "strengths scatter more than the simulator's",
        .mechanism = "Contact, alignment and reflections vary from message to message.",
        .equation = "sd of ln s (1 + m)",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.strength_spread", -0.9, 5.0, 0.5, {0.2}, "0.36 at contact, 0.11-0.15 beyond"}},
        .needs = {},
        .observables = "scatter of strength",
        .enters = "ir.frame_noise, ir.receiver_noise, ir.near_noise",
        .confounded = {"strength_spread_parts"},
        .separated_by = "several pairs of boards at one distance, turned",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
