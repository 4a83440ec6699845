#include "gap/effects/list.h"

namespace puckloop::gap {

Effect motor_noise() {
    return {
        .name = "motor_noise",
        .number = 29,
        .title = "running motors make the readings noisy",
        .mechanism = "Supply ripple of the stepping motors.",
        .equation = "sd (1 + m |v| / 1000)",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.motor_noise", -0.5, 20.0, 1.0, {0.3}, "0.2..1 at 800 steps/s"}},
        .needs = {"motor_speed"},
        .observables = "scatter with motors on",
        .enters = "proximity.motor_noise",
        .confounded = {"proportional_noise"},
        .separated_by = "the same distance with wheels on and off",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
