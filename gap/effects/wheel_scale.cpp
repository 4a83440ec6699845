#include "gap/effects/list.h"

namespace puckloop::gap {

Effect wheel_scale() {
    return {
        .name = "wheel_scale",
        .number = 1,
        .title = "both wheels are larger or smaller than assumed",
        .mechanism =
            "Tyre wear, load and manufacture change the rolling radius of both wheels by the same share.",
        .equation = "d = (1 + s) k steps",
        .kinds = {Kind::Motion},
        .parameters = {{"wheel_scale",
                        -0.08,
                        0.08,
                        0.02,
                        {},
                        "-3..+3 %; 41.0 against 41.35 mm is 0.85 %; -0.4 % on another robot"}},
        .needs = {},
        .observables = "way along",
        .enters = "robot.wheel_radius_left and _right together",
        .confounded = {"tracker_delay", "command_latency", "turn_scrub"},
        .separated_by =
            "straight runs of two lengths, checked with a ruler (a wrong tracker scale looks the same)",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
