#include "gap/selftest/design_motion.h"
#include "gap/selftest/rigs.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

constexpr double kRow = 0.1;                                    // s
constexpr double kPlaceNoise = 0.001;                           // m
constexpr double kAngleNoise = 0.5 * std::numbers::pi / 180;    // rad
constexpr double kPlaceQuantum = 1e-4;                          // m
constexpr double kAngleQuantum = 0.1 * std::numbers::pi / 180;  // rad

HiddenExperiment exact_motion(const MotionKnobs& knobs, std::uint64_t seed, const std::string& variant) {
    RandomStream random(seed, "drives");
    HiddenExperiment experiment;
    experiment.kind = "motion";
    experiment.instrument = {{"x_m", fmt::format("{{ quantum = {} }}", kPlaceQuantum)},
                             {"y_m", fmt::format("{{ quantum = {} }}", kPlaceQuantum)}};
    int order = 0;
    for (const PlannedDrive& plan : planned_drives(random, variant == "one circle")) {
        ++order;
        const auto rows =
            drive(knobs, plan.script, kRow, RandomStream(seed, fmt::format("chance {}", order)));
        HiddenRun run;
        run.conditions = {{"path", plan.path}, {"sense", plan.sense}};
        for (const MotionRow& r : rows) {
            run.column("t_s", "s").values.push_back(r.t);
            run.column("x_m", "m").values.push_back(r.x);
            run.column("y_m", "m").values.push_back(r.y);
            run.column("theta_rad", "rad").values.push_back(r.theta);
            run.column("steps_left", "1").values.push_back(r.steps_left);
            run.column("steps_right", "1").values.push_back(r.steps_right);
            run.column("cmd_left", "steps/s").values.push_back(r.cmd_left);
            run.column("cmd_right", "steps/s").values.push_back(r.cmd_right);
            run.column("load_kg", "kg").values.push_back(plan.script.load);
            run.column("order", "1").values.push_back(order);
        }
        experiment.runs.push_back(std::move(run));
    }
    return experiment;
}

void measure_motion(HiddenExperiment& experiment, const MotionKnobs&, const NoiseStyle& style,
                    std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        HiddenRun& run = experiment.runs[r];
        const auto blur = [&](const char* name, const char* unit, double sd, double quantum) {
            NoiseSeries noise(style, sd, RandomStream(seed, fmt::format("{} {}", name, r)));
            for (double& value : run.column(name, unit).values)
                value = quantised(value + noise.next(), quantum);
        };
        blur("x_m", "m", kPlaceNoise, kPlaceQuantum);
        blur("y_m", "m", kPlaceNoise, kPlaceQuantum);
        blur("theta_rad", "rad", kAngleNoise, kAngleQuantum);
    }
}

}  // namespace

const Rig<MotionKnobs>& motion_rig() {
    static const Rig<MotionKnobs> rig{
        "motion",
        {{"x_m", kPlaceNoise}, {"y_m", kPlaceNoise}, {"theta_rad", kAngleNoise}},
        exact_motion,
        measure_motion,
        [](const MotionKnobs&, std::uint64_t, const std::string&) { return 0.0; }};
    return rig;
}

}  // namespace puckloop::gap::selftest
