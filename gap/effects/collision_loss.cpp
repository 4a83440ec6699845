#include "gap/effects/list.h"

namespace puckloop::gap {

Effect collision_loss() {
    return {
        .name = "collision_loss",
        .number = 52,
        .title = "frames of several senders collide",
        .mechanism = "Boards that do not listen before sending overlap.",
        .equation = "p_ok = exp(-2 (N - 1) T_frame / T_period)",
        .kinds = {Kind::Rab},
        .parameters =
            {{"rab.collisions", 0.0, 2.0, 0.5, {0.3}, "1 for senders that know nothing of each other"}},
        .needs = {"senders"},
        .observables = "reception by number of senders",
        .enters = "emerges from boards that send",
        .confounded = {"random_loss", "poll_loss"},
        .separated_by = "the same place with one, two and four senders",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
