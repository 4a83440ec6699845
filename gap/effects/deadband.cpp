#include "gap/effects/list.h"

namespace puckloop::gap {

Effect deadband() {
    return {
        .name = "deadband",
        .number = 9,
        .title = "slow commands do not move the robot",
        .mechanism = "Static friction or detent holds the wheel below a least speed.",
        .equation = "v = 0 for |v| < c0",
        .kinds = {Kind::Motion},
        .parameters = {{"robot.deadband",
                        1.0,
                        500.0,
                        80.0,
                        {60.0},
                        "near 0 for a good stepper, 20 % of the range for DC motors"}},
        .needs = {},
        .observables = "way along, heading",
        .enters = "robot.deadband (physics/wheel_drive)",
        .confounded = {"backlash"},
        .separated_by = "commands in small steps through zero",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
