#include "gap/effects/list.h"

namespace puckloop::gap {

Effect sensor_direction() {
    return {
        .name = "sensor_direction",
        .number = 28,
        .title = "sensors look in other directions than the drawing says",
        .mechanism = "Bent leads turn a sensor.",
        .equation = "angle_i + delta_i",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.direction*", -3.6, 3.6, 0.08, {}, "+-8 degrees between published tables"}},
        .needs = {"angle_rad"},
        .observables = "readings at oblique walls, odd in the angle",
        .enters = "proximity.direction",
        .confounded = {"incidence"},
        .separated_by = "a wall turned through both signs of the angle before each sensor",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
