// Floor sensors.

#include "gap/effects/tables.h"

namespace puckloop::gap {

std::vector<Effect> ground_effects() {
    return {
        // Parts and their height differ from robot to robot. y = o_i + g_i f(grey)
        {
            .name = "ground_gain",
            .number = 36,
            .title = "the ground sensors have other gains and offsets",
            .parameters = {{"ground.gain*", 0.1, 3.0, 0.2, "black 81..677 between 30 robots"},
                           {"ground.offset*", -500.0, 500.0, 60.0, "as gain"}},
            .enters = "ground.gain, ground.offset",
            .separated_by = "black and white paper under each sensor",
        },
        // The nose lifts when the robot accelerates; or the board sits higher than drawn.
        // signal (1 - s lift)
        {
            .name = "ground_height",
            .number = 37,
            .title = "the board's height or tilt changes the readings",
            .parameters = {{"ground.acceleration_tilt", -1.0, 1.0, 0.05, "correlates with acceleration"},
                           {"ground.raised", -0.01, 0.01, 0.002, "1-2 mm"}},
            .needs = {"acceleration"},
            .enters = "ground.height, ground.acceleration_tilt",
            .separated_by = "starts and stops on one plain grey",
        },
        // The board is mounted further ahead or aside. grey at x + dx
        {
            .name = "ground_position",
            .number = 38,
            .title = "the ground sensors stand elsewhere than drawn",
            .parameters = {{"ground.forward_error", -0.05, 0.05, 0.005, "edges shift with heading"},
                           {"ground.left_error", -0.02, 0.02, 0.004, "?"}},
            .needs = {"grey_rate"},
            .enters = "ground.x, ground.y",
            .separated_by = "an edge crossed at two speeds and in both directions",
        },
        // Sampling and transport hold the reading back. grey where the robot was tau ago
        {
            .name = "ground_lag",
            .number = 38,
            .title = "the ground sensors answer late",
            .parameters = {{"ground.lag", -0.05, 1.0, 0.1, "18 of 37 samples of pitch"}},
            .needs = {"grey_rate"},
            .enters = "ground.lag, less the emulated board's and host's own share",
            .separated_by = "an edge crossed at two speeds and in both directions",
        },
    };
}

}  // namespace puckloop::gap
