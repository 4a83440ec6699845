#pragma once
// Drives whose tracker and counters do not tell the same time.

#include "base/random.h"
#include "gap/data/experiment.h"

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

namespace puckloop::gap::test {

inline constexpr double kBegins = 1.0, kLasts = 60.0;  // s

/// A drive of speeds that change smoothly; the pose in the row of time t (s) belongs to late(t) s before it.
/// `wobble`: a wheel out of round, share of its speed, once in 0.37 s. `uneven`: share of the time between
/// rows by which rows may come later.
inline Run drive(const std::string& name, const std::function<double(double)>& late, double axle_error,
                 double wobble = 0.0, double uneven = 0.0) {
    constexpr double kMetre = 1e-4, kAxle = 0.2, kStep = 0.1, kFine = 0.001;
    RandomStream random(1, "clocks test " + name);
    const double phase = 6 * random.uniform();
    const auto speeds = [phase](double t) {
        const double v = 0.1 + 0.05 * std::sin(0.5 * t + phase), w = 0.6 * std::sin(0.8 * t + 2 * phase);
        return std::pair{v - w * kAxle / 2, v + w * kAxle / 2};
    };
    std::vector<double> left{0}, right{0}, x{0}, y{0}, theta{0};
    for (double t = 0; t < kLasts + 3; t += kFine) {
        const auto [l, r] = speeds(t);
        left.push_back(left.back() + l * kFine / kMetre);
        right.push_back(right.back() + r * kFine / kMetre);
        const double turn = (r - l) * kFine / (kAxle * (1 + axle_error));
        const double way = (l + r) / 2 * kFine * (1 + wobble * std::sin(2 * std::numbers::pi * t / 0.37));
        x.push_back(x.back() + way * std::cos(theta.back()));
        y.push_back(y.back() + way * std::sin(theta.back()));
        theta.push_back(theta.back() + turn);
    }
    Run run;
    run.name = run.file = name;
    for (double even = kBegins; even < kLasts; even += kStep) {
        const double t = uneven > 0 ? even + uneven * kStep * random.uniform() : even;
        const auto counted = static_cast<std::size_t>(std::lround(t / kFine));
        const auto seen = static_cast<std::size_t>(std::lround((t - late(t)) / kFine));
        run.columns["t_s"].push_back(t);
        run.columns["steps_left"].push_back(std::round(left[counted]));
        run.columns["steps_right"].push_back(std::round(right[counted]));
        run.columns["x_m"].push_back(x[seen] + 5e-4 * random.normal());
        run.columns["y_m"].push_back(y[seen] + 5e-4 * random.normal());
        run.columns["theta_rad"].push_back(theta[seen] + 2e-3 * random.normal());
        ++run.rows;
    }
    return run;
}

inline Experiment of(std::vector<Run> runs) {
    Experiment experiment;
    experiment.kind = Kind::Motion;
    experiment.runs = std::move(runs);
    return experiment;
}

}  // namespace puckloop::gap::test
