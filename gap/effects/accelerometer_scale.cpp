#include "gap/effects/list.h"

namespace puckloop::gap {

Effect accelerometer_scale() {
    return {
        .name = "accelerometer_scale",
        .number = 39,
        .title = "the accelerometer's scale or axes are off",
        .mechanism = "Sensitivity differs by axis; the chip is turned on its board.",
        .equation = "gain_i R(turn) a",
        .kinds = {Kind::Accelerometer},
        .parameters = {{"accelerometer.scale*", 0.5, 1.6, 0.06, {}, "744-800 counts a g"},
                       {"accelerometer.turn", -0.6, 0.6, 0.1, {}, "?"}},
        .needs = {},
        .observables = "each axis, in proportion",
        .enters = "accelerometer.scale, accelerometer.turn",
        .confounded = {"accelerometer_bias"},
        .separated_by = "all six faces down",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
