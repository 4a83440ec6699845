#include "gap/effects/list.h"

namespace puckloop::gap {

Effect random_loss() {
    return {
        .name = "random_loss",
        .number = 53,
        .title = "messages are lost whoever sends",
        .mechanism = "Weak light, interference, interrupts.",
        .equation = "p_ok = 1 - q",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.random_loss", 0.0, 0.95, 0.15, {0.05}, "30 % to 85 % reported"}},
        .needs = {},
        .observables = "reception",
        .enters = "ir.loss, beside the losses that emerge",
        .confounded = {"beat_loss", "collision_loss"},
        .separated_by = "one sender only, many messages in a row",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
