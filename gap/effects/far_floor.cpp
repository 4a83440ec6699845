#include "gap/effects/list.h"

namespace puckloop::gap {

Effect far_floor() {
    return {
        .name = "far_floor",
        .number = 48,
        .title = "far strengths stay up",
        .mechanism = "Background and automatic gain keep far readings above a floor.",
        .equation = "s = max(s, floor)",
        .kinds = {Kind::Rab},
        .parameters = {{"rab.far_floor", 100.0, 3000.0, 400.0, {950.0, 1150.0}, "median 920 beyond 45 cm"}},
        .needs = {},
        .observables = "strength at large distance",
        .enters = "ir.level",
        .confounded = {"strength_spread_parts"},
        .separated_by = "distances beyond half a metre",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
