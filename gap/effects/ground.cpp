// Floor sensors.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> ground_effects() {
    return {
        {
            .name = "ground_gain",
            .number = 36,
            .title = "the ground sensors have other gains and offsets",
            .mechanism = "Parts and their height differ from robot to robot.",
            .equation = "y = o_i + g_i f(grey)",
            .kinds = {Kind::Ground},
            .parameters = {{"ground.gain*", 0.1, 3.0, 0.2, {}, "black 81..677 between 30 robots"},
                           {"ground.offset*", -500.0, 500.0, 60.0, {}, "as gain"}},
            .observables = "all readings of a sensor",
            .enters = "ground.gain, ground.offset",
            .confounded = {"ground_height"},
            .separated_by = "black and white paper under each sensor",
        },
        {
            .name = "ground_height",
            .number = 37,
            .title = "the board's height or tilt changes the readings",
            .mechanism = "The nose lifts when the robot accelerates; or the board sits higher than drawn.",
            .equation = "signal (1 - s lift)",
            .kinds = {Kind::Ground},
            .parameters = {{"ground.acceleration_tilt", -1.0, 1.0, 0.05, {}, "correlates with acceleration"},
                           {"ground.raised", -0.01, 0.01, 0.002, {}, "1-2 mm"}},
            .needs = {"acceleration"},
            .observables = "readings at starts and stops",
            .enters = "ground.height, ground.acceleration_tilt",
            .confounded = {"ground_gain"},
            .separated_by = "starts and stops on one plain grey",
        },
        {
            .name = "ground_position",
            .number = 38,
            .title = "the ground sensors stand elsewhere than drawn",
            .mechanism = "The board is mounted further ahead or aside.",
            .equation = "grey at x + dx",
            .kinds = {Kind::Ground},
            .parameters = {{"ground.forward_error", -0.05, 0.05, 0.005, {}, "edges shift with heading"},
                           {"ground.left_error", -0.02, 0.02, 0.004, {}, "?"}},
            .needs = {"grey_rate"},
            .observables = "readings where the grey changes",
            .enters = "ground.x, ground.y",
            .confounded = {"ground_lag"},
            .separated_by = "an edge crossed at two speeds and in both directions",
        },
        {
            .name = "ground_lag",
            .number = 38,
            .title = "the ground sensors answer late",
            .mechanism = "Sampling and transport hold the reading back.",
            .equation = "grey where the robot was tau ago",
            .kinds = {Kind::Ground},
            .parameters = {{"ground.lag", -0.05, 1.0, 0.1, {}, "18 of 37 samples of pitch"}},
            .needs = {"grey_rate"},
            .observables = "readings where the grey changes, in proportion to speed",
            .enters = "ground.lag, less the emulated board's and host's own share",
            .confounded = {"ground_position"},
            .separated_by = "an edge crossed at two speeds and in both directions",
        },
    };
}

}  // namespace puckloop::gap
