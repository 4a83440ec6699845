#include "gap/effects/list.h"

namespace puckloop::gap {

Effect reflectivity() {
    return {
        .name = "reflectivity",
        .number = 26,
        .title = "a surface reflects otherwise than assumed",
        .mechanism = "Material and colour set what comes back, for all sensors alike.",
        .equation = "factor rho for one object",
        .kinds = {Kind::Proximity},
        .parameters = {{"object.reflectivity*|proximity.scale",
                        0.02,
                        3.0,
                        0.3,
                        {},
                        ".05 black .. 1 white .. 1.5 foil; one object: a common factor"}},
        .needs = {},
        .observables = "all sensors before one object",
        .enters = "reflectivity of the thing in the scenario; proximity.scale with one object",
        .confounded = {"sensor_gain", "response_law"},
        .separated_by = "two surfaces before every sensor",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
