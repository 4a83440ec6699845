#include "gap/effects/list.h"

namespace puckloop::gap {

Effect rab_lobe() {
    return {
        .name = "rab_lobe",
        .number = 46,
        .title = "emitters or receivers are more or less directed",
        .mechanism = "Diodes and detectors of another make, or set deeper in the ring.",
        .equation = "light cos(a)^n, strength cos(b)^m",
        .kinds = {Kind::Rab},
        .parameters =
            {{"rab.emitter_lobe", 0.1, 12.0, 0.5, {2.0}, "1: a wide diode; 12: 20 degrees to the half"},
             {"rab.receiver_lobe", 0.1, 6.0, 0.25, {1.0}, "0.5: what the board's formula assumes"}},
        .needs = {},
        .observables = "strength by direction, bearing",
        .enters = "ir.emitter_exponent, ir.receiver_exponent",
        .confounded = {"rab_strength_scale", "strength_spread_parts"},
        .separated_by = "one emitter at a time, the sender turned",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
