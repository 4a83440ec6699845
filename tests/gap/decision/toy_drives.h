#pragma once
// Drives to and fro without a world model, for what sums of a drive show.

#include "base/random.h"
#include "gap/data/experiment.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>

namespace puckloop::gap {

inline constexpr int kToyRuns = 8, kToyLegs = 4, kToyLeg = 30;        // rows of a leg
inline constexpr double kToyRow = 0.1;                                // s
inline constexpr double kToySpeed = 500;                              // steps/s: 20 ticks of the agenda
inline constexpr double kToyMetre = std::numbers::pi * 0.041 / 1000;  // of a step

/// A row's own change of the pose: share of the way made, push (m), its direction from the heading and by how
/// much it turns the robot (rad).
struct Made {
    double share = 1.0, push = 0.0, direction = 0.0, turn = 0.0;
};

/// Drives to and fro, each along a line of its own; row k of a leg, x before it. The tracker errs by 1 mm, of
/// which a share `carry` is kept from row to row, and by 5 mrad.
inline Experiment toy_drives(const std::function<Made(RandomStream&, int leg, int k, double x)>& made,
                             std::uint64_t seed = 5, double carry = 0.0) {
    RandomStream random(seed, "toy drives"), chance(seed + 1, "toy drives");
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.title = "toy";
    experiment.nominal["inverse_friction"] = 0.0;
    for (int r = 0; r < kToyRuns; ++r) {
        Run run;
        run.name = "run" + std::to_string(r);
        double heading = 0.8 * r / kToyRuns;
        const double begun = -0.15 * random.uniform();
        double x = begun * std::cos(heading), y = begun * std::sin(heading);
        std::array<double, 2> error{};
        for (int i = 0; i <= kToyLegs * kToyLeg; ++i) {
            const auto command = [](int row) { return row / kToyLeg % 2 == 0 ? kToySpeed : -kToySpeed; };
            if (i > 0) {
                const int before = i - 1;
                const Made one = made(chance, before / kToyLeg, before % kToyLeg, x);
                const double way = command(before) * kToyRow * kToyMetre * one.share,
                             direction = heading + one.direction;
                x += way * std::cos(heading) + one.push * std::cos(direction);
                y += way * std::sin(heading) + one.push * std::sin(direction);
                heading += one.turn;
            }
            const double next = command(std::min(i, kToyLegs * kToyLeg - 1));
            for (double& one : error)
                one = (i > 0 ? carry * one : 0.0) +
                      (i > 0 ? std::sqrt(1 - carry * carry) : 1.0) * random.normal();
            run.columns["t_s"].push_back(kToyRow * i);
            run.columns["cmd_left"].push_back(next);
            run.columns["cmd_right"].push_back(next);
            run.columns["x_m"].push_back(x + 1e-3 * error[0]);
            run.columns["y_m"].push_back(y + 1e-3 * error[1]);
            run.columns["theta_rad"].push_back(heading + 5e-3 * random.normal());
            ++run.rows;
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

}  // namespace puckloop::gap
