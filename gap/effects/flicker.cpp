#include "gap/effects/list.h"

namespace puckloop::gap {

Effect flicker() {
    return {
        .name = "flicker",
        .number = 23,
        .title = "lamps flicker",
        .mechanism = "Mains light swings at 100 Hz and is seen at its alias.",
        .equation = "y += a sin(2 pi f t + phi) in light",
        .kinds = {Kind::Proximity},
        .parameters =
            {{"proximity.flicker", 0.0, 300.0, 15.0, {8.0}, "2..30 counts"},
             {"proximity.flicker_frequency", 0.02, 35.0, 5.0, {}, "alias of 100 Hz; found in the spectrum"}},
        .needs = {"t_s"},
        .observables = "a spectral line, in light only",
        .enters = "proximity.flicker, proximity.flicker_frequency; light.flicker is of the ambient counts",
        .confounded = {"ambient_light"},
        .separated_by = "the same stillness in the dark and in light",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
