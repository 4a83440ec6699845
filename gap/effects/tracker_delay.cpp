#include "gap/effects/list.h"

namespace puckloop::gap {

Effect tracker_delay() {
    return {
        .name = "tracker_delay",
        .number = 16,
        .title = "the tracker is late",
        .mechanism = "Exposure, processing and transport delay the pose.",
        .equation = "pose(t) belongs to t - tau",
        .kinds = {Kind::Motion},
        .parameters = {{"tracker.delay", -0.05, 0.8, 0.06, {0.04, 0.12}, "1..3 frames, 50..100 ms"}},
        .needs = {},
        .observables = "everything that changes speed",
        .enters = "measuring chain",
        .confounded = {"command_latency", "backlash", "acceleration_slip"},
        .separated_by = "log the step counters with the robot's clock, or flash an LED that the tracker sees",
        .measuring_chain = true,
    };
}

}  // namespace puckloop::gap
