// The forward model of motion against a robot stepped at 1 ms by other formulas: the same with nothing wrong,
// and with each effect at the true value of its parameter.

#include "tests/gap/models/exact_tables.h"
#include "tests/gap/models/made_table.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace puckloop::gap;
using selftest::MotionKnobs;
using Values = std::map<std::string, double>;

namespace {

constexpr double kWay = 1.5e-4;   // m: a step of the motor is 0.13 mm
constexpr double kTurn = 1.5e-3;  // rad
constexpr double kSteps = 0.5;

struct Case {
    const char* name;
    void (*turn)(MotionKnobs&);
    Values truth;
    const char* shows;  ///< where it shows most
    double by;          ///< without it the model is off by this much at least
};

Exact<MotionKnobs> exact(const Case& one, MotionView view = MotionView::Robot) {
    MotionKnobs knobs;
    one.turn(knobs);
    return {selftest::motion_rig(), knobs, one.name, view};
}

const std::vector<Case>& cases() {
    // clang-format off
    static const std::vector<Case> list{
        {"wheel_scale", [](MotionKnobs& k) { k.radius_scale = 1.02; }, {{"wheel_scale", 0.02}}, "along", 5e-3},
        {"mismatch", [](MotionKnobs& k) { k.mismatch = 0.005; }, {{"wheel_mismatch", 0.005}}, "heading", 0.05},
        {"axle", [](MotionKnobs& k) { k.axle_scale = 1.02; }, {{"robot.axle_length", 0.053 * 1.02}}, "heading", 0.05},
        {"scrub", [](MotionKnobs& k) { k.scrub = 0.02; }, {{"robot.turn_scrub", 0.02}}, "heading", 0.03},
        {"slip", [](MotionKnobs& k) { k.friction = 0.05; }, {{"inverse_friction", 20}}, "along", 3e-3},
        {"creep", [](MotionKnobs& k) { k.creep = 0.2; }, {{"robot.load_creep", 0.2}}, "along", 1e-3},
        {"deadband", [](MotionKnobs& k) { k.deadband = 50; }, {{"robot.deadband", 50}}, "along", 2e-3},
        {"latency", [](MotionKnobs& k) { k.latency = 0.05; }, {{"command.latency", 0.05}}, "steps_left", 10},
        {"pull", [](MotionKnobs& k) { k.pull_x = 1e-3; k.pull_y = -2e-3; },
            {{"robot.drift_x", 1e-3}, {"robot.drift_y", -2e-3}}, "across", 2e-3},
        {"marker", [](MotionKnobs& k) { k.marker_x = 5e-3; k.marker_y = 3e-3; },
            {{"tracker.marker_x", 5e-3}, {"tracker.marker_y", 3e-3}}, "across", 0.01},
        {"delay", [](MotionKnobs& k) { k.tracker_delay = 0.05; }, {{"tracker.delay", 0.05}}, "along", 2e-3},
        {"heading_drift", [](MotionKnobs& k) { k.heading_drift = 0.01; }, {{"tracker.heading_drift", 0.01}}, "across", 0.01},
    };
    // clang-format on
    return list;
}

}  // namespace

TEST_CASE("with nothing wrong the model of motion drives as the plain robot does") {
    const Exact<MotionKnobs> rest(selftest::motion_rig(), {}, "rest");
    CHECK(rest.misfit("along", {}) < kWay);
    CHECK(rest.misfit("across", {}) < kWay);
    CHECK(rest.misfit("heading", {}) < kTurn);
    CHECK(rest.misfit("steps_left", {}) < kSteps);
    CHECK(rest.misfit("steps_right", {}) < kSteps);
}

TEST_CASE("each effect of motion moves the model as it moves the plain robot") {
    for (const Case& one : cases()) {
        INFO(one.name);
        const auto table = exact(one);
        CHECK(table.misfit(one.shows, {}) > one.by);
        CHECK(table.misfit("along", one.truth) < kWay);
        CHECK(table.misfit("across", one.truth) < kWay);
        CHECK(table.misfit("heading", one.truth) < kTurn);
        CHECK(table.misfit("steps_left", one.truth) < kSteps);
    }
}

TEST_CASE("each effect of motion leads to the same places in the room") {
    constexpr double kPlace = 5e-4;  // m, after up to 1.6 m and several turns
    for (const Case& one : cases()) {
        INFO(one.name);
        const auto table = exact(one, MotionView::Room);
        CHECK(table.misfit("x_m", one.truth) < kPlace);
        CHECK(table.misfit("y_m", one.truth) < kPlace);
        CHECK(table.misfit("heading", one.truth) < kTurn);
    }
}

TEST_CASE("the latency that fits counters best is the one that was performed") {
    for (const double latency : {0.0064453125, 0.01100006, 0.038671875}) {
        MotionKnobs knobs;
        knobs.latency = latency;
        const Exact<MotionKnobs> table(selftest::motion_rig(), knobs, "latency");
        double best = 0.0, least = INFINITY;
        for (double off = -1e-3; off < 1e-3; off += 5e-5) {
            // The plain robot counts a step when it is half done.
            const double misfit =
                table.misfit("steps_left", {{"command.latency", latency + off}, {"counter.late_step", 0.0}});
            if (misfit >= least) continue;
            least = misfit;
            best = off;
        }
        INFO(latency);
        CHECK(std::abs(best) < 3e-4);  // s: a sixth of a step, what whole steps leave at a few speeds
    }
}

TEST_CASE("counters follow the latency without a jump") {
    constexpr double kStep = 5e-5, kFastest = 1000;  // s, steps/s
    const Exact<MotionKnobs> table(selftest::motion_rig(), {}, "smooth");
    Prediction last = tests::predicted(table.model());
    for (double latency = kStep; latency < 0.02; latency += kStep) {
        const Prediction next = tests::predicted(table.model(), {{"command.latency", latency}});
        double most = 0.0;
        for (std::size_t i = 0; i < next[3].mean.size(); ++i)
            most = std::max(most, std::abs(next[3].mean[i] - last[3].mean[i]));
        CHECK(most < kFastest * kStep + 1e-9);
        last = next;
    }
}

TEST_CASE("play softens the slide of a reversal") {
    MotionKnobs knobs;
    knobs.backlash = 1.25e-3;
    const Exact<MotionKnobs> table(selftest::motion_rig(), knobs, "backlash");
    const double angle = 1.25e-3 / 0.0205;
    CHECK(table.misfit("heading", {}) > 5e-3);
    CHECK(table.misfit("heading", {{"robot.backlash", angle}}) < 2e-3);
    CHECK(table.misfit("along", {{"robot.backlash", angle}}) < kWay);
    CHECK(table.misfit("along", {{"robot.backlash", 0.65 * angle}}) >
          table.misfit("along", {{"robot.backlash", angle}}));
}

TEST_CASE("lost groups of steps take their share of the way") {
    MotionKnobs knobs;
    knobs.loss_speed = 950;
    knobs.loss_width = 60;
    const Exact<MotionKnobs> table(selftest::motion_rig(), knobs, "loss");
    const Values truth{{"robot.step_loss_speed", 950}, {"robot.step_loss_width", 60}};
    CHECK(table.misfit("along", {}) > 0.02);
    CHECK(table.misfit("along", truth) < 0.15 * table.misfit("along", {}));  // chance decides each group
}

TEST_CASE("a dead band is looked for between the speeds that moved nothing and those that did") {
    MotionKnobs knobs;
    knobs.deadband = 50;
    const Exact<MotionKnobs> table(selftest::motion_rig(), knobs, "deadband_start");
    const auto starts = table.model().starts("robot.deadband");
    REQUIRE(starts.size() == 1);
    CHECK(starts[0] > 42);
    CHECK(starts[0] < 56);
    const Exact<MotionKnobs> rest(selftest::motion_rig(), {}, "no_deadband");
    CHECK(rest.model().starts("robot.deadband").empty());
}

TEST_CASE("a push is not looked for where a command changed, and a lost command only there") {
    const Exact<MotionKnobs> rest(selftest::motion_rig(), {}, "rest_lapses");
    auto values = rest.model().neutral();
    values.at(*rest.model().find("push.rate")) = 0.1;
    values.at(*rest.model().find("command.loss")) = 0.1;
    Prediction prediction;
    rest.model().predict(values, prediction);
    std::size_t pushed = 0, lost = 0;
    for (const double chance : prediction[0].lapse)
        pushed += chance > 0 ? 1 : 0;
    for (const double chance : prediction[3].lapse)
        lost += chance > 0.05 ? 1 : 0;
    const std::size_t rows = prediction[0].lapse.size();
    CHECK(pushed > rows / 2);
    CHECK(pushed < rows);
    CHECK(lost > 50);
    CHECK(lost < rows / 5);
}

TEST_CASE("friction is given as the simulator's own number or as what the model moves") {
    const auto friction = [](const std::map<std::string, double>& nominal) {
        const tests::Table table{
            {"t_s", {0, 0.1, 0.2, 0.3}}, {"x_m", {0, 0, 0, 0.01}},         {"y_m", {0, 0, 0, 0}},
            {"theta_rad", {0, 0, 0, 0}}, {"cmd_left", {0, 500, 500, 500}}, {"cmd_right", {0, 500, 500, 500}}};
        const Experiment experiment = tests::experiment_of(Kind::Motion, table, nominal);
        const auto model = make_model(experiment);
        return model->neutral()[*model->find("inverse_friction")];
    };
    CHECK(friction({}) == Approx(1 / 0.7));
    CHECK(friction({{"contact.mu", 0.35}}) == Approx(1 / 0.35));
    CHECK(friction({{"contact.mu", 0.35}, {"inverse_friction", 0.0}}) == 0.0);
}
