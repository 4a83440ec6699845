#include "physics/description/robot_constants.h"
#include "selftest/benches/bench.h"
#include "selftest/benches/benches.h"
#include "selftest/benches/design_motion.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

namespace puckloop::gap::selftest {

namespace {

using Truths = std::vector<Truth>;
constexpr double kDrawnRadius = physics::kWheelRadius, kDrawnAxle = physics::kAxleLength;

constexpr double kMotionRow = 0.1;                              // s
constexpr double kPlaceNoise = 0.001;                           // m
constexpr double kAngleNoise = 0.5 * std::numbers::pi / 180;    // rad
constexpr double kPlaceQuantum = 1e-4;                          // m
constexpr double kAngleQuantum = 0.1 * std::numbers::pi / 180;  // rad

WrittenExperiment exact_motion(const MotionKnobs& knobs, std::uint64_t seed, const std::string& variant) {
    RandomStream random(seed, "drives");
    WrittenExperiment experiment;
    experiment.kind = "motion";
    experiment.instruments = {{"x_m", NAN, NAN, kPlaceQuantum}, {"y_m", NAN, NAN, kPlaceQuantum}};
    int order = 0;
    for (const PlannedDrive& plan : planned_drives(random, variant == "one circle")) {
        ++order;
        const auto rows =
            drive(knobs, plan.script, kMotionRow, RandomStream(seed, fmt::format("chance {}", order)));
        WrittenRun run;
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

void measure_motion(WrittenExperiment& experiment, const MotionKnobs&, const NoiseStyle& style,
                    std::uint64_t seed) {
    for (std::size_t r = 0; r < experiment.runs.size(); ++r) {
        WrittenRun& run = experiment.runs[r];
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
        {{"x_m", kPlaceNoise, true}, {"y_m", kPlaceNoise, true}, {"theta_rad", kAngleNoise}},
        exact_motion,
        measure_motion,
        [](const MotionKnobs&, std::uint64_t, const std::string&) { return 0.0; }};
    return rig;
}

std::unique_ptr<Bench> motion_bench() {
    // clang-format off
    return std::make_unique<BenchOf<MotionKnobs>>(motion_rig(), std::vector<HiddenEffect<MotionKnobs>>{
        {1, "wheel radius", 0.03, true, [](MotionKnobs& k, double a, RandomStream) {
            k.radius_scale = 1 + a;
            return Truths{{"wheel_scale", a}}; }},
        {2, "wheel mismatch", 0.01, true, turned(&MotionKnobs::mismatch, "wheel_mismatch")},
        {3, "axle length", 0.04, true, [](MotionKnobs& k, double a, RandomStream) {
            k.axle_scale = 1 + a;
            return Truths{{"robot.axle_length", kDrawnAxle * (1 + a)}}; }},
        {4, "scrub", 0.04, false, turned(&MotionKnobs::scrub, "robot.turn_scrub")},
        // friction falls from 0.7 to 0.02
        {5, "slip at starts", 1.0, false, [](MotionKnobs& k, double a, RandomStream) {
            k.friction = 0.7 * std::pow(0.02 / 0.7, a);
            return Truths{{"inverse_friction", 1 / k.friction}}; }},
        {6, "creep under load", 0.5, false, turned(&MotionKnobs::creep, "robot.load_creep")},
        {7, "step loss", 1.0, false, [](MotionKnobs& k, double a, RandomStream) {
            k.loss_speed = 1100 - 300 * a; k.loss_width = 60;
            return Truths{{"robot.step_loss_speed", k.loss_speed}}; }},
        {9, "dead band", 120, false, turned(&MotionKnobs::deadband, "robot.deadband")},
        {10, "backlash", 0.004, false, [](MotionKnobs& k, double a, RandomStream) {
            k.backlash = a;
            return Truths{{"robot.backlash", a / kDrawnRadius}}; }},
        {11, "command latency", 0.15, false, turned(&MotionKnobs::latency, "command.latency")},
        // of 128 changes of speed 2, 8 and 19 are lost
        {12, "lost commands", 0.15, false, turned(&MotionKnobs::drop, "command.loss"),
            std::array{0.015, 0.06, 0.15}},
        {13, "pull in the world", 0.01, false, [](MotionKnobs& k, double a, RandomStream r) {
            const double way = 2 * std::numbers::pi * r.uniform();
            k.pull_x = a * std::cos(way); k.pull_y = a * std::sin(way);
            return Truths{{"robot.drift_x", k.pull_x}, {"robot.drift_y", k.pull_y}}; }},
        {14, "pushes", 0.05, false, [](MotionKnobs& k, double a, RandomStream) { k.push_rate = 0.05; k.push_size = a; return Truths{}; }},
        {15, "marker off the axle", 0.02, false, [](MotionKnobs& k, double a, RandomStream r) {
            const double way = 2 * std::numbers::pi * r.uniform();
            k.marker_x = a * std::cos(way); k.marker_y = a * std::sin(way);
            return Truths{{"tracker.marker_x", k.marker_x}, {"tracker.marker_y", k.marker_y}}; }},
        {16, "tracker delay", 0.2, false, turned(&MotionKnobs::tracker_delay, "tracker.delay")},
        {17, "heading drift", 0.02, true, turned(&MotionKnobs::heading_drift, "tracker.heading_drift")},
        // a circle of one sense only: a mismatch and another axle look the same
        {2, "mismatch on one circle", 0.01, true, turned(&MotionKnobs::mismatch),
            {}, "one circle", 3},
        {3, "axle on one circle", 0.04, true, [](MotionKnobs& k, double a, RandomStream) { k.axle_scale = 1 + a; return Truths{}; },
            {}, "one circle", 2},
        {0, "wheel out of round", 0.3, false, turned(&MotionKnobs::eccentricity)},
        {0, "tracker's lens", 2.0, true, turned(&MotionKnobs::lens)},
        {0, "slippery patch", 0.8, false, turned(&MotionKnobs::patch)},
        {0, "kick at reversals", 0.5, true, turned(&MotionKnobs::thrust)},
    });
    // clang-format on
}

}  // namespace puckloop::gap::selftest
