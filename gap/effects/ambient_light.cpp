#include "gap/effects/list.h"

namespace puckloop::gap {

Effect ambient_light() {
    return {
        .name = "ambient_light",
        .number = 22,
        .title = "room light changes the readings",
        .mechanism =
            "Light adds an offset and noise, and takes gain where the phototransistor nears its rail.",
        .equation = "y = f(d) (1 - k a) + b a, sd^2 grows with a",
        .kinds = {Kind::Proximity},
        .parameters = {{"proximity.ambient_offset", -500.0, 500.0, 50.0, {}, "+60..+140 counts"},
                       {"proximity.ambient_gain", -0.3, 0.9, 0.1, {}, "y* = 1 - amb / 4095"},
                       {"proximity.ambient_noise", 0.0, 200.0, 8.0, {2.0}, "sd ~ sqrt(ambient)"}},
        .needs = {"ambient"},
        .observables = "all readings in light",
        .enters = "proximity.ambient_offset, proximity.ambient_gain, proximity.ambient_noise",
        .confounded = {"sensor_offset", "flicker"},
        .separated_by = "every distance once in the dark and once in light",
        .measuring_chain = false,
    };
}

}  // namespace puckloop::gap
