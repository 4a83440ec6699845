// The world model does what the forward model of motion says for the same parameters: steps are fed to a
// robot in the world, without firmware, and its path is what the model predicts with the parameter and is not
// what it predicts without.

#include "gap/models/model.h"
#include "tests/gap/models/made_table.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::gap;
using puckloop::gap::tests::experiment_of;
using puckloop::gap::tests::predicted;
using puckloop::gap::tests::Table;
using Values = std::map<std::string, double>;

namespace {

struct Leg {
    double seconds, left, right;
};

constexpr int kRow = 100;  // ms

/// Speeds that the firmware's timers make exactly: divisors of 230.4 kHz.
const std::vector<Leg>& legs() {
    static const std::vector<Leg> list{
        {0.5, 0, 0},  {3, -300, 300}, {1, 0, 0},       {3, 450, 450}, {1, 0, 0},      {3, 300, 450},
        {1, 0, 0},    {3, 400, 400},  {3, -400, -400}, {1, 0, 0},     {3, 40, 40},    {3, 80, 80},
        {3, -40, 80}, {1, 0, 0},      {2, 0, 600},     {1, 0, 0},     {2, 600, -600}, {1, 0, 0}};
    return list;
}

/// The drive in the world, as a tracker without noise sees it. `world` holds for the model, too.
Experiment driven(const Values& values, const Values& world) {
    auto description = physics::test::world_with_robot(6, 6);
    description.robots[0].heading = 0.7;
    description.parameters = values;
    description.parameters.insert(world.begin(), world.end());
    physics::WorldModel model(description);
    physics::test::Driver driver(model);
    const double rise = std::sin(model.parameters().world.slope_x);
    Table table;
    const auto row = [&](const Leg& leg) {
        const auto& state = model.state(0);
        table["t_s"].push_back(model.seconds());
        table["x_m"].push_back(state.x);
        table["y_m"].push_back(state.y);
        table["theta_rad"].push_back(state.heading);
        table["cmd_left"].push_back(leg.left);
        table["cmd_right"].push_back(leg.right);
        table["load_kg"].push_back(model.robot(0).body().load);
        table["incline_rad"].push_back(std::asin(rise * std::cos(state.heading)));
    };
    for (const Leg& leg : legs())
        for (int ms = 0; ms < std::lround(leg.seconds * 1e3); ++ms) {
            if (ms % kRow == 0) row(leg);
            driver.feed(leg.left, leg.right);
            model.step();
        }
    row({});
    return experiment_of(Kind::Motion, table, {{"firmware.agenda", 0}});
}

/// Largest error of the model with these parameters, m and rad.
struct Misfit {
    double along = 0.0, across = 0.0, heading = 0.0;
};

Misfit misfit(const Experiment& experiment, const Values& changed) {
    const auto model = make_model(experiment);
    Values told = changed;
    told["tracker.heading_span"] = std::log(0.02);  // a tracker without noise
    const Prediction prediction = predicted(*model, told);
    const auto most = [&](std::size_t o) {
        const auto& y = model->observables()[o].y;
        double error = 0.0;
        for (std::size_t i = 0; i < y.size(); ++i)
            error = std::max(error, std::abs(y[i] - prediction[o].mean[i]));
        return error;
    };
    return {most(0), most(1), most(2)};
}

struct Case {
    Values values, world;           ///< the effect; what the robot does besides
    double along, across, heading;  ///< without the effect the model is off by this much at least (0: any)
};

// The model's own errors over 30 s and 3 m: what starts and stops lose, and that a wheel runs a step late.
constexpr double kWay = 4e-4;    // m
constexpr double kAside = 1e-4;  // m
constexpr double kTurn = 0.01;   // rad, of 40 turned
// An effect may add so much to them.
constexpr double kMoreWay = 5e-4, kMoreAside = 1e-4, kMoreTurn = 6e-3;

}  // namespace

TEST_CASE("with nothing changed the world goes where the motion model does") {
    const Misfit m = misfit(driven({}, {}), {});
    CAPTURE(m.along, m.across, m.heading);
    CHECK(m.along < kWay);
    CHECK(m.across < kAside);
    CHECK(m.heading < kTurn);
}

TEST_CASE("each effect moves the robot in the world as it moves the motion model") {
    const Case one = GENERATE(values<Case>({
        {{{"robot.turn_scrub", 0.04}}, {}, 0, 0, 0.2},
        {{{"robot.load_creep", 0.1}}, {{"robot.load", 0.2}}, 8e-3, 0, 0.15},
        {{{"robot.slope_creep", 0.3}}, {{"world.slope_x", 0.1}}, 8e-3, 0, 0.03},
        {{{"robot.drift_x", 0.002}, {"robot.drift_y", -0.0015}}, {}, 5e-3, 5e-3, 0},
        {{{"robot.deadband", 60}}, {}, 0.01, 0, 0.1},
    }));
    const Experiment experiment = driven(one.values, one.world);
    const Misfit with = misfit(experiment, one.values), without = misfit(experiment, {});
    const Misfit own = misfit(driven({}, one.world), {});  // the model's, on this floor with this load
    CAPTURE(one.values.begin()->first, with.along, with.across, with.heading, own.along, own.across,
            own.heading, without.along, without.across, without.heading);
    CHECK(with.along < own.along + kMoreWay);
    CHECK(with.across < own.across + kMoreAside);
    CHECK(with.heading < own.heading + kMoreTurn);
    CHECK(without.along > one.along);
    CHECK(without.across > one.across);
    CHECK(without.heading > one.heading);
}
