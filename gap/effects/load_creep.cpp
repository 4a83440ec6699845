#include "gap/effects/list.h"

namespace puckloop::gap {

Effect load_creep() {
    return {
        .name = "load_creep",
        .number = 6,
        .title = "the tyres creep under load",
        .mechanism =
            "Rubber under a driving force rolls with a small steady slip that grows with load and slope.",
        .equation = "v = (1 - c load - c2 incline) v_command",
        .kinds = {Kind::Motion},
        .parameters = {{"robot.load_creep", -0.1, 1.0, 0.1, {}, "0..3 % of travel"},
                       {"robot.slope_creep", -0.5, 1.0, 0.2, {}, "?"}},
        .needs = {"load_kg|incline_rad"},
        .observables = "way along, heading",
        .enters = "robot.load_creep with robot.load, robot.slope_creep with world.slope_x, world.slope_y "
                  "(physics/floor_motion)",
        .confounded = {"wheel_scale"},
        .separated_by = "the same runs with and without added mass, and on a slope",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
