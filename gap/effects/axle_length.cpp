#include "gap/effects/list.h"

namespace puckloop::gap {

Effect axle_length() {
    return {
        .name = "axle_length",
        .number = 3,
        .title = "the wheels stand further apart or closer than assumed",
        .mechanism = "The points of contact are not where the drawing has them.",
        .equation = "turn = turn_odometry L0 / L",
        .kinds = {Kind::Motion},
        .parameters =
            {{"robot.axle_length", 0.02, 1.0, 0.0015, {}, "0..4 %; published models disagree by 4 %"}},
        .needs = {},
        .observables = "heading",
        .enters = "robot.axle_length",
        .confounded = {"wheel_mismatch", "turn_scrub", "command_latency"},
        .separated_by = "spot turns and circles of both senses",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
