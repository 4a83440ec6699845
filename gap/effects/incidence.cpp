#include "gap/effects/list.h"

namespace puckloop::gap {

Effect incidence() {
    return {
        .name = "incidence",
        .number = 27,
        .title = "oblique surfaces reflect otherwise",
        .mechanism = "Surfaces are not perfectly diffuse; the beam is wide.",
        .equation = "cos^m(angle)",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.incidence_exponent", 0.0, 4.0, 0.5, {}, "m 1..2"}},
        .needs = {"angle_rad"},
        .observables = "readings at oblique walls",
        .enters = "proximity.incidence_exponent",
        .confounded = {"sensor_direction"},
        .separated_by = "a wall turned through both signs of the angle",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
