#include "gap/effects/list.h"

namespace puckloop::gap {

Effect fifo_overrun() {
    return {
        .name = "fifo_overrun",
        .number = 59,
        .title = "bytes are lost when interrupts wait",
        .mechanism = "The receiver's four-byte buffer overflows while other interrupts run: fields shift.",
        .equation = "p(shift) = q load",
        .kinds = {Kind::Timing},
        .parameters = {{"timing.overrun", 0.0, 1.0, 0.1, {0.05}, "blocked over 350 us"}},
        .needs = {"load"},
        .observables = "shifted fields by load",
        .enters = "emerges from the emulated board",
        .confounded = {"truncation"},
        .separated_by = "the same traffic with the analogue service off",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
