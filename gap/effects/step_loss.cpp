#include "gap/effects/list.h"

namespace puckloop::gap {

Effect step_loss() {
    return {
        .name = "step_loss",
        .number = 7,
        .title = "the motors lose steps above a speed",
        .mechanism =
            "Above its pull-out speed a stepper skips whole groups of four steps; the counter does not know.",
        .equation = "share lost = 1 / (1 + exp(-(|v| - v0) / w))",
        .kinds = {Kind::Motion},
        .parameters =
            {{"robot.step_loss_speed", 200.0, 2000.0, 400.0, {750.0, 900.0, 1050.0}, "v0 700..1000 steps/s"},
             {"robot.step_loss_width", 5.0, 200.0, 50.0, {}, "w 30..100 steps/s"}},
        .needs = {},
        .observables = "way along, heading",
        .enters = "robot.step_loss_speed, robot.step_loss_width",
        .confounded = {"wheel_scale"},
        .separated_by = "straight runs at several speeds below and above the suspected threshold",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
