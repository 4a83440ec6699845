#include "gap/effects/list.h"

namespace puckloop::gap {

Effect baud_mismatch() {
    return {
        .name = "baud_mismatch",
        .number = 58,
        .title = "the two ends disagree about the baud rate",
        .mechanism = "An oscillator is off: bytes with long runs are misread.",
        .equation = "p(frame wrong) grows with edges",
        .kinds = {Kind::Timing},
        .parameters = {{"timing.edge_errors", 0.0, 0.5, 0.01, {0.005}, "0 at 14.7456 MHz; 2.1 % at 16 MHz"}},
        .needs = {"edges"},
        .observables = "frames wrong by byte pattern",
        .enters = "the overlay's [uart] answer_edge_loss",
        .confounded = {"truncation"},
        .separated_by = "frames of 0x55 against frames of 0x00 and 0xFF",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
