#include "gap/effects/list.h"

namespace puckloop::gap {

Effect crosstalk() {
    return {
        .name = "crosstalk",
        .number = 25,
        .title = "sensors see their neighbours' light",
        .mechanism = "The pulse of the partner, or of the neighbour, reaches this receiver.",
        .equation = "y_i += sum_j k_ij y_j",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.pair_crosstalk", -0.05, 0.4, 0.03, {}, "k .01..0.05"},
                       {"proximity.neighbour_crosstalk", -0.05, 0.4, 0.03, {}, ".02"}},
        .needs = {"pair_reading|neighbour_reading"},
        .observables = "readings of sensors whose neighbours see something",
        .enters = "proximity.pair_crosstalk, proximity.neighbour_crosstalk",
        .confounded = {"sensor_gain"},
        .separated_by = "an object before one sensor only",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
