#include "gap/effects/list.h"

namespace puckloop::gap {

Effect rab_strength_scale() {
    return {
        .name = "rab_strength_scale",
        .number = 26,
        .title = "all strengths are higher or lower",
        .mechanism = "Emitter power, window or supply.",
        .equation = "ln s + g",
        .kinds = {Kind::Rab},
        .parameters =
            {{"rab.strength_gain", -2.0, 2.0, 0.25, {}, "641 against 1050 counts at 20 cm between robots"}},
        .needs = {},
        .observables = "strength",
        .enters = "ir.receiver_gain, all twelve",
        .confounded = {"strength_spread_parts"},
        .separated_by = "a second pair of boards",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
