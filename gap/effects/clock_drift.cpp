#include "gap/effects/list.h"

namespace puckloop::gap {

Effect clock_drift() {
    return {
        .name = "clock_drift",
        .number = 62,
        .title = "the clocks of robot and host run apart",
        .mechanism = "Crystals differ by tens of ppm, RC oscillators by percents.",
        .equation = "t_host = (1 + rho) t_robot",
        .kinds = {Kind::Timing},
        .parameters =
            {{"timing.clock_drift", -0.2, 0.2, 0.003, {0.003, -0.003}, "+-50 ppm; 1-2 % without crystal"}},
        .needs = {"t_robot_s"},
        .observables = "arrival, growing with time",
        .enters = "the overlay's [clock] pic_error",
        .confounded = {"long_period"},
        .separated_by = "a longer run",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
