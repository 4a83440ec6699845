#include "gap/effects/list.h"

namespace puckloop::gap {

Effect backlash() {
    return {
        .name = "backlash",
        .number = 10,
        .title = "the gears have play",
        .mechanism = "On reversal the motor turns some way before the wheel follows.",
        .equation = "play operator of width b on each wheel",
        .kinds = {Kind::Motion},
        .parameters =
            {{"robot.backlash", 0.0, 0.3, 0.03, {0.01, 0.04}, "0.5-2 degrees at the wheel: 0.2-0.7 mm"}},
        .needs = {},
        .observables = "way along, heading",
        .enters = "robot.backlash",
        .confounded = {"acceleration_slip", "tracker_delay"},
        .separated_by = "reversals without a stop beside stops and starts in one direction",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
