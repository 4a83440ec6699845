#include "gap/effects/list.h"

namespace puckloop::gap {

Effect poll_loss() {
    return {
        .name = "poll_loss",
        .number = 54,
        .title = "the host polls too slowly",
        .mechanism = "The board's queue overflows.",
        .equation = "p_ok = min(1, capacity / rate)",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.fetch_time", 0.0, 0.5, 0.02, {0.02, 0.04}, "50 messages a second at 20 ms"}},
        .needs = {"arrival_rate|senders"},
        .observables = "reception by message rate",
        .enters = "emerges from the poll period of the Linux program",
        .confounded = {"collision_loss"},
        .separated_by = "the same senders with a faster and a slower poll",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
