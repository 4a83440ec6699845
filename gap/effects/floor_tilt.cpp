#include "gap/effects/list.h"

namespace puckloop::gap {

Effect floor_tilt() {
    return {
        .name = "floor_tilt",
        .number = 13,
        .title = "something pulls the robot one way in the world",
        .mechanism = "A tilted floor, a magnet or a cable pulls in a direction fixed in the room.",
        .equation = "displacement = g t in a fixed direction while driving",
        .kinds = {Kind::Motion},
        .parameters = {{"robot.drift_x", -0.05, 0.05, 0.003, {}, "?"},
                       {"robot.drift_y", -0.05, 0.05, 0.003, {}, "?"}},
        .needs = {},
        .observables = "way along and across",
        .enters = "robot.drift_x, robot.drift_y (physics/floor_motion)",
        .confounded = {"marker_offset"},
        .separated_by = "the same run with other headings at the start",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
