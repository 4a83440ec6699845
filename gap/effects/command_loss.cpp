#include "gap/effects/list.h"

namespace puckloop::gap {

Effect command_loss() {
    return {
        .name = "command_loss",
        .number = 12,
        .title = "commands get lost and the old one is kept",
        .mechanism = "A frame on the way to the robot is dropped; the wheels go on as before.",
        .equation = "with probability p a command does nothing",
        .kinds = {Kind::Motion},
        .parameters = {{"command.loss", 0.0, 0.5, 0.05, {0.01, 0.05}, "0..5 %"}},
        .needs = {"cmd_left"},
        .observables = "steps, way along, heading: rare errors of whole commands",
        .enters = "the overlay's [uart] command_loss",
        .confounded = {"collision_push"},
        .separated_by = "log sequence numbers at both ends",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
