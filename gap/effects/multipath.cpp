#include "gap/effects/list.h"

namespace puckloop::gap {

Effect multipath() {
    return {
        .name = "multipath",
        .number = 51,
        .title = "messages come by reflections",
        .mechanism = "Another path wins: longer, weaker, from elsewhere.",
        .equation = "with probability w: ln s - l, bearing scattered",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.multipath", 0.0, 0.7, 0.08, {0.05}, "w .05..0.2"},
                       {"rab.multipath_loss", 0.1, 2.5, 0.5, {}, "-3..-10 dB"}},
        .needs = {},
        .observables = "outliers of strength and bearing",
        .enters = "ir.stray, ir.stray_loss, beside the scenario's walls and bodies",
        .confounded = {"range_noise"},
        .separated_by = "the same in the middle of an empty room",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
