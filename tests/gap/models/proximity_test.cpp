// The proximity model against the simulator's own sensors: one robot, its right-hand sensor before a wall.

#include "physics/world/world_model.h"
#include "tests/gap/models/made_table.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::gap;
using namespace puckloop::gap::tests;

namespace {

using Changes = std::map<std::string, double>;
constexpr double kRadius = 0.031;  // m from the axle's middle to sensor 2, which looks at -90 degrees
constexpr double kExact = 3e-5;    // the table's -90 degrees have five digits: 4e-6 rad at an oblique wall

struct Place {
    double gap, heading;  // m along the sensor's axis to the wall, rad
};

/// Counts of all eight sensors of a robot whose sensor 2 sees the wall at `place`.
std::vector<double> simulated(const Place& place, const Changes& parameters, double ambient = 0.0) {
    physics::World world = physics::test::world_with_robot(1, 1);
    world.ambient_light = ambient;
    world.parameters = parameters;
    world.robots[0].heading = place.heading;
    world.robots[0].y = -0.5 + (kRadius + place.gap) * std::cos(place.heading);
    const auto channels = physics::WorldModel(world).robot(0).channels();
    return {channels.begin() + physics::kProximityChannel, channels.begin() + physics::kProximityChannel + 8};
}

const std::vector<Place> kPlaces{{0.007, 0}, {0.012, 0}, {0.031, 0.4}, {0.02, -0.7}, {0.055, 0.1}, {0.09, 0}};

Table table(const std::vector<double>& ambient = {}) {
    Table rows;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        rows["t_s"].push_back(0.1 * static_cast<double>(i));
        rows["sensor"].push_back(2);
        rows["distance_m"].push_back(kPlaces[i].gap);
        rows["angle_rad"].push_back(-kPlaces[i].heading);
        rows["reading"].push_back(100);
    }
    if (!ambient.empty()) rows["ambient"] = ambient;
    return rows;
}

void check_same(const Changes& changes, const Changes& nominal = {}) {
    const Experiment experiment = experiment_of(Kind::Proximity, table(), nominal);
    const auto model = make_model(experiment);
    const Prediction said = predicted(*model, changes);
    Changes all = nominal;
    for (const auto& [name, value] : changes)
        all[name] = value;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        INFO((changes.empty() ? "neutral" : changes.begin()->first) << ", row " << i);
        CHECK(shown(said[0], i) == Approx(simulated(kPlaces[i], all)[2]).epsilon(kExact));
    }
}

}  // namespace

TEST_CASE("neutral, the proximity model is the simulator's sensor") {
    check_same({});
    check_same({}, {{"proximity.curve", 1}});
}

TEST_CASE("each parameter of the proximity model acts as the simulator's of the same name") {
    check_same({{"proximity.gain2", 1.3}});
    check_same({{"proximity.offset2", 12}});
    check_same({{"proximity.scale", 0.7}});
    check_same({{"proximity.direction2", -1.5707963 + 0.12}});
    check_same({{"proximity.incidence_exponent", 1.8}});
    check_same({{"proximity.extra_exponent", 0.4}});
    check_same({{"proximity.distance_shift", 0.003}});
    check_same({{"proximity.compression", 1e-4}});
    check_same({{"proximity.threshold", 250}});
    const Changes law{{"proximity.curve", 1}};
    check_same({{"proximity.amplitude", 3e5}}, law);
    check_same({{"proximity.exponent", 1.8}}, law);
    check_same({{"proximity.origin", 0.006}}, law);
    check_same({{"proximity.saturation", 2500}}, law);
}

TEST_CASE("room light takes gain and adds counts as in the simulator") {
    const Experiment experiment =
        experiment_of(Kind::Proximity, table(std::vector<double>(kPlaces.size(), 0.8)));
    const auto model = make_model(experiment);
    const Changes changes{{"proximity.ambient_gain", 0.2}, {"proximity.ambient_offset", 30}};
    const Prediction said = predicted(*model, changes);
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
        CHECK(said[0].mean[i] == Approx(simulated(kPlaces[i], changes, 0.8)[2]).epsilon(kExact));
}

TEST_CASE("neighbours' crosstalk takes their readings without what they read idle and of the sensor itself") {
    const Changes changes{{"proximity.neighbour_crosstalk", 0.03}};
    Table rows = table();
    rows["reading"].clear();
    for (const Place& place : kPlaces) {
        const auto all = simulated(place, changes);
        rows["reading"].push_back(all[2]);
        rows["neighbour_reading"].push_back(all[1] + all[3]);
    }
    const auto model = make_model(experiment_of(Kind::Proximity, rows));
    const Prediction said = predicted(*model, changes);
    const double second_neighbours = 1.5e-3;  // share: what they cast on the neighbours, who hand it on
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
        CHECK(said[0].mean[i] == Approx(rows["reading"][i]).epsilon(second_neighbours));
}

TEST_CASE("the opposite sensor's crosstalk is asked only where light of its own reaches that sensor") {
    const double share = 0.04;
    Table rows = table(), dark = table();
    rows["reading"].clear();
    const std::vector<double> light{0, 900, 300, 1500, 0, 600};  // counts of the opposite sensor, its own
    const Changes none;
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        const auto all = simulated(kPlaces[i], none);
        const double idle = simulated({0.5, 0}, none)[2], own = all[2] - idle;
        rows["reading"].push_back(all[2] + share * light[i]);
        rows["pair_reading"].push_back(all[6] + light[i] + share * own);
        dark["pair_reading"].push_back(all[6] + share * own);
    }
    dark["reading"] = rows["reading"];
    const auto model = make_model(experiment_of(Kind::Proximity, rows));
    const Prediction said = predicted(*model, {{"proximity.pair_crosstalk", share}});
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
        CHECK(said[0].mean[i] == Approx(rows["reading"][i]).epsilon(1e-3));
    CHECK(!make_model(experiment_of(Kind::Proximity, dark))->find("proximity.pair_crosstalk"));
}

TEST_CASE("time, motors, battery and age move a reading by what their equations say") {
    Table rows = table();
    rows["t_s"] = {0, 100, 200, 300, 400, 500};
    rows["motor_speed"] = {0, 800, 0, -800, 300, 0};
    rows["battery_v"] = {3.6, 3.7, 3.8, 3.6, 3.7, 3.8};
    rows["velocity"] = {0, 0.05, 0.05, -0.05, 0, 0};
    rows["order"] = {1, 1, 2, 2, 3, 3};
    const Experiment experiment = experiment_of(Kind::Proximity, rows);
    const auto model = make_model(experiment);
    const Prediction rest = predicted(*model);
    const double idle = physics::Parameters().proximity.offset[2];
    const auto answer = [&](const Prediction& p, std::size_t i) { return p[0].mean[i] - idle; };

    const Prediction warm =
        predicted(*model, {{"proximity.warmup_gain", 0.1}, {"proximity.warmup_time", 250}});
    const Prediction sagged = predicted(*model, {{"proximity.motor_sag", 0.02}});
    const Prediction drooped = predicted(*model, {{"proximity.battery_gain", 0.2}});
    const Prediction drifted = predicted(*model, {{"proximity.order_drift", 0.01}});
    const Prediction noisy = predicted(*model, {{"proximity.motor_noise", 0.5}});
    for (std::size_t i = 0; i < kPlaces.size(); ++i) {
        const double seconds = rows["t_s"][i], speed = rows["motor_speed"][i];
        CHECK(answer(warm, i) == Approx(answer(rest, i) * (1 + 0.1 * (1 - std::exp(-seconds / 250)))));
        CHECK(sagged[0].mean[i] == Approx(rest[0].mean[i] * (speed != 0 ? 0.98 : 1.0)));
        CHECK(answer(drooped, i) == Approx(answer(rest, i) * (1 + 0.2 * (rows["battery_v"][i] - 3.7))));
        CHECK(answer(drifted, i) == Approx(answer(rest, i) * (1 + 0.01 * (rows["order"][i] - 2))));
        CHECK(noisy[0].factor[i] == Approx(1 + 0.5 * std::abs(speed) / 1000));
    }
    // A reading 60 ms old belongs to where the wall was then.
    const Prediction aged = predicted(*model, {{"proximity.age", 0.06}});
    Table before = rows;
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
        before["distance_m"][i] -= 0.06 * rows["velocity"][i];
    const Experiment earlier = experiment_of(Kind::Proximity, before);
    const Prediction then = predicted(*make_model(earlier));
    for (std::size_t i = 0; i < kPlaces.size(); ++i)
        CHECK(aged[0].mean[i] == Approx(then[0].mean[i]));
}

TEST_CASE("a lamp's flicker is found on the sensors' sampling schedule") {
    constexpr double kSchedule = 63.015, kMains = 100.0, kCounts = 20.0;  // Hz, Hz, counts
    Table rows;
    for (int i = 0; i < 60; ++i) {
        const double t = 0.1 * i, sampled = std::floor(t * kSchedule) / kSchedule;
        rows["t_s"].push_back(t);
        rows["sensor"].push_back(2);
        rows["distance_m"].push_back(0.2);
        rows["ambient"].push_back(1);
        rows["reading"].push_back(60 + kCounts * std::sin(2 * M_PI * kMains * sampled));
    }
    const Experiment experiment = experiment_of(Kind::Proximity, rows);
    const auto model = make_model(experiment);
    const auto starts = model->starts("proximity.flicker_frequency");
    REQUIRE(starts.size() == 1);
    CHECK(starts[0] == Approx(2 * kSchedule - kMains).margin(0.1));
}

TEST_CASE("nobody knows at which run the simulator was right: a drift between runs has a zero of its own") {
    Experiment runs = experiment_of(Kind::Proximity, table());
    for (int more = 0; more < 2; ++more)
        runs.runs.push_back(runs.runs.front());
    for (std::size_t r = 0; r < 3; ++r)
        runs.runs[r].columns["order"].assign(kPlaces.size(), static_cast<double>(r) + 1);
    const auto model = make_model(runs);
    const Prediction rest = predicted(*model);
    const Prediction drifted =
        predicted(*model, {{"proximity.order_drift", 0.01}, {"proximity.order_zero", 1.0}});
    const double idle = physics::Parameters().proximity.offset[2];
    for (std::size_t i = 0; i < rest[0].mean.size(); ++i) {
        const double order = runs.runs[model->observables()[0].run[i]].columns["order"][0];
        CHECK(drifted[0].mean[i] - idle == Approx((rest[0].mean[i] - idle) * (1 + 0.01 * (order - 3))));
    }
    // Row by row it would go with the distance.
    for (Run& run : runs.runs)
        for (std::size_t i = 0; i < kPlaces.size(); ++i)
            run.columns["order"][i] = static_cast<double>(i);
    CHECK(make_model(runs)->find("proximity.order_drift"));
    CHECK(!make_model(runs)->find("proximity.order_zero"));
}

TEST_CASE("the age's start is found though few rows move and most are far") {
    constexpr double kAge = 0.0123;  // s
    Table rows;
    for (int i = 0; i < 200; ++i) {
        const bool moves = i % 20 == 0;
        const double distance = moves ? 0.005 + 4e-4 * i : 0.03;
        rows["t_s"].push_back(0.1 * i);
        rows["sensor"].push_back(0);
        rows["distance_m"].push_back(distance);
        rows["velocity"].push_back(moves ? -0.12 : 0.0);
        rows["reading"].push_back(0);
    }
    const auto read = [&] {
        const Experiment experiment = experiment_of(Kind::Proximity, rows);
        const auto model = make_model(experiment);
        return std::pair(predicted(*model, {{"proximity.age", kAge}})[0].mean,
                         model->starts("proximity.age"));
    };
    rows["reading"] = read().first;
    for (std::size_t i = 0; i < 200; ++i)
        rows["reading"][i] += i % 2 == 0 ? 4.0 : -4.0;
    const auto starts = read().second;
    REQUIRE(starts.size() == 1);
    CHECK(starts[0] == Approx(kAge).epsilon(0.1));
    rows["velocity"].assign(200, 0.0);
    CHECK(read().second.empty());
}

TEST_CASE("the dead zone's start parts the readings of nothing from the others") {
    Table rows = table();
    rows["reading"] = {2400, 1150, 0, 330, 0, 0};
    const Experiment experiment = experiment_of(Kind::Proximity, rows);
    const auto model = make_model(experiment);
    const auto starts = model->starts("proximity.threshold");
    REQUIRE(starts.size() == 1);
    const Prediction rest = predicted(*model);
    CHECK(starts[0] > rest[0].mean[2]);
    CHECK(starts[0] <= 330);
    CHECK(make_model(experiment_of(Kind::Proximity, table()))->starts("proximity.threshold").empty());
}

TEST_CASE("foreign pulses are looked for on the side of the ring that they hit") {
    Table rows;
    for (int sensor = 0; sensor < 8; ++sensor)
        for (int i = 0; i < 80; ++i) {
            const bool front = sensor < 2 || sensor > 5;
            rows["sensor"].push_back(sensor);
            rows["distance_m"].push_back(0.03);
            rows["t_s"].push_back(8.0 * sensor + 0.1 * i);
            rows["reading"].push_back(290 + i * 7 % 5 + (front && i % 8 == 0 ? 60 : 0));
        }
    const Experiment experiment = experiment_of(Kind::Proximity, rows);
    const Prediction said = predicted(*make_model(experiment), {{"proximity.interference_rate", 0.1}});
    const auto model = make_model(experiment);
    REQUIRE(said[0].lapse.size() == rows["sensor"].size());
    for (std::size_t i = 0; i < said[0].lapse.size(); ++i) {
        const double sensor = rows["sensor"][i];
        CHECK(said[0].lapse[i] == Approx(sensor < 2 || sensor > 5 ? 0.1 : 0.0));
    }
    const std::map<std::string, double> sheltered{{"proximity.interference_share2", 0},
                                                  {"proximity.interference_share3", 0},
                                                  {"proximity.interference_share4", 0},
                                                  {"proximity.interference_share5", 0}};
    CHECK(model->implied() == sheltered);
}
