#include "gap/effects/list.h"

namespace puckloop::gap {

Effect heading_drift() {
    return {
        .name = "heading_drift",
        .number = 17,
        .title = "the heading drifts with time",
        .mechanism = "Gyro bias or a warming tracker turns the heading even at rest.",
        .equation = "d theta / dt = r",
        .kinds = {Kind::Motion},
        .parameters = {{"tracker.heading_drift", -0.2, 0.2, 0.005, {}, "?"}},
        .needs = {},
        .observables = "heading",
        .enters = "measuring chain",
        .confounded = {"wheel_mismatch"},
        .separated_by = "let the robot stand for a minute with the tracker on",
        .measuring_chain = true,
    };
}

}  // namespace puckloop::gap
