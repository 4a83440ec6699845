#include "gap/effects/list.h"

namespace puckloop::gap {

Effect collision_push() {
    return {
        .name = "collision_push",
        .number = 14,
        .title = "the robot is pushed now and then",
        .mechanism = "Collisions and hands move the robot without its wheels.",
        .equation = "with rate q the pose jumps by about s",
        .kinds = {Kind::Motion},
        .parameters = {{"push.rate", 0.0, 1.0, 0.03, {0.02}, "rare"},
                       {"push.size", 0.001, 0.2, 0.03, {0.004, 0.02}, "mm to cm"},
                       {"push.turn", 0.0, 3.0, 0.3, {0.0, 0.05}, "none to a turn"}},
        .needs = {},
        .observables = "rare jumps of all pose components",
        .enters =
            "push.rate, push.size, push.turn (physics/floor_motion); other robots and things push as well",
        .confounded = {"command_loss"},
        .separated_by = "film the arena; a run with nobody near",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
