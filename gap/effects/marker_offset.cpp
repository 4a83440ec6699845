#include "gap/effects/list.h"

namespace puckloop::gap {

Effect marker_offset() {
    return {
        .name = "marker_offset",
        .number = 15,
        .title = "the marker is not on the axle",
        .mechanism =
            "The tracker follows a point beside the middle of the axle, or a marker turned against the body.",
        .equation = "seen = p + R(theta) (dx, dy), theta + d",
        .kinds = {Kind::Motion},
        .parameters = {{"tracker.marker_x", -0.06, 0.06, 0.004, {}, "1..5 mm"},
                       {"tracker.marker_y", -0.06, 0.06, 0.004, {}, "1..5 mm"},
                       {"tracker.marker_angle", -0.4, 0.4, 0.05, {}, "0..5 degrees"}},
        .needs = {},
        .observables = "way across and along in turns",
        .enters = "measuring chain",
        .confounded = {"axle_length"},
        .separated_by = "a spot turn: the centre then draws a circle",
        .measuring_chain = true,
    };
}

}  // namespace puckloop::gap
