#include "gap/effects/list.h"

namespace puckloop::gap {

Effect wheel_mismatch() {
    return {
        .name = "wheel_mismatch",
        .number = 2,
        .title = "one wheel is larger than the other",
        .mechanism = "Unequal rolling radii bend straight lines.",
        .equation = "curvature = 2 e / L, e = (rR - rL) / (rR + rL)",
        .kinds = {Kind::Motion},
        .parameters = {{"wheel_mismatch", -0.04, 0.04, 0.006, {}, "0..1 %"}},
        .needs = {},
        .observables = "heading, way across",
        .enters = "robot.wheel_radius_left and _right apart",
        .confounded = {"axle_length", "heading_drift"},
        .separated_by =
            "drive squares both clockwise and counter-clockwise, and a straight line forward and backward",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
