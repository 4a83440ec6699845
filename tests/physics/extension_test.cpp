// Terms without a mechanism: each enters where its quantity does, by as much as its table says.

#include "physics/robot/extension.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <numbers>

using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

constexpr double kRoundAxle =
    2 * std::numbers::pi * 0.0205 / 1000 / 0.053;  // rad a step of both wheels apart

ExtensionTerm term(const std::string& adds_to, std::vector<ExtensionAxis> over, std::vector<double> value) {
    ExtensionTerm one;
    one.adds_to = adds_to;
    one.over = std::move(over);
    one.value = std::move(value);
    return one;
}

RobotState driven(const std::vector<ExtensionTerm>& terms, double left, double right, double seconds,
                  std::uint64_t seed = 1) {
    World description = world_with_robot(6, 6);
    description.extension = terms;
    description.seed = seed;
    WorldModel world(description);
    Driver driver(world);
    driver.drive(left, right, seconds);
    driver.drive(0, 0, 0.5);
    return world.state(0);
}

}  // namespace

TEST_CASE("a table gives straight lines between its places and its ends beyond them") {
    const Extension extension(
        {term("ground.reading", {{"grey", {0, 0.5, 1}}, {"time", {0, 10}}}, {0, 10, 5, 15, 20, 40})}, 1,
        "e1");
    Moment now{};
    const auto at = [&](double grey, double time) {
        known(now, Known::Grey) = grey;
        known(now, Known::Time) = time;
        return extension.of(Extended::Ground, 1, now);
    };
    CHECK(at(0, 0) == Approx(0));
    CHECK(at(0.25, 0) == Approx(2.5));
    CHECK(at(0.25, 5) == Approx(7.5));
    CHECK(at(0.75, 10) == Approx(27.5));
    CHECK(at(2, 20) == Approx(40));
    CHECK(extension.asks(Extended::Ground, Known::Grey));
    CHECK_FALSE(extension.asks(Extended::Ground, Known::Level));
    CHECK_FALSE(extension.adds_to(Extended::Proximity));
    CHECK_FALSE(extension.moves());
}

TEST_CASE("a term of motion takes a driven robot along, and leaves one that stands alone") {
    const auto plain = driven({}, 400, 400, 5.0);
    // 5 mm/s at 0.05 m/s ahead, none at rest.
    const auto ahead = driven({term("motion.forward", {{"speed", {0, 0.05}}}, {0, 0.005})}, 400, 400, 5.0);
    CHECK(ahead.x - plain.x == Approx(0.025).epsilon(0.06));
    CHECK(std::abs(ahead.y) < 1e-3);
    const auto turned = driven({term("motion.turn", {}, {0.1})}, 400, 400, 5.0);
    CHECK(turned.heading - plain.heading == Approx(0.5).epsilon(0.05));
    const auto aside = driven({term("motion.left", {}, {0.004})}, 400, 400, 5.0);
    CHECK(aside.y - plain.y == Approx(0.02).epsilon(0.05));
    const auto stood = driven({term("motion.turn", {}, {0.1}), term("motion.left", {}, {0.01})}, 0, 0, 5.0);
    CHECK(std::abs(stood.y) < 1e-6);
    CHECK(std::abs(stood.heading) < 1e-6);
}

TEST_CASE("a term may be a share of what the wheels turn") {
    auto share = term("motion.turn", {}, {0.05});
    share.times = "turn_rate";
    const auto plain = driven({}, -200, 200, 4.0), more = driven({share}, -200, 200, 4.0);
    REQUIRE(plain.heading == Approx(4 * 400 * kRoundAxle).epsilon(0.01));
    CHECK(more.heading - plain.heading == Approx(0.05 * 4 * 400 * kRoundAxle).epsilon(0.06));
}

TEST_CASE("each run draws its own offset, the same for the same seed") {
    auto offset = term("motion.turn", {}, {0.0});
    offset.run_spread = 0.05;
    const double first = driven({offset}, 400, 400, 2.0, 1).heading,
                 again = driven({offset}, 400, 400, 2.0, 1).heading,
                 other = driven({offset}, 400, 400, 2.0, 2).heading;
    CHECK(first == again);
    CHECK(std::abs(first - other) > 1e-3);
}

TEST_CASE("readings gain what their table says, of the sensor that it is for") {
    World description = world_with_robot(2, 2);
    description.parameters = {{"ground.noise", 0}};
    auto counts = term("ground.reading", {{"grey", {0, 1}}}, {50, -30});
    counts.sensor = 1;
    const auto channels = [&](const std::vector<ExtensionTerm>& terms) {
        World world = description;
        world.extension = terms;
        WorldModel model(world);
        for (int ms = 0; ms < 100; ++ms)
            model.step();
        return model.robot(0).channels();
    };
    const auto plain = channels({}), with = channels({counts});
    CHECK(with[kGroundChannel] == plain[kGroundChannel]);
    CHECK(with[kGroundChannel + 1] == Approx(plain[kGroundChannel + 1] - 30).margin(1e-9));
    const auto axes = channels({term("accelerometer.z", {}, {12})});
    CHECK(axes[kAccelerationChannel + 2] == Approx(plain[kAccelerationChannel + 2] + 12).margin(1e-9));
}

TEST_CASE("a proximity sensor's term goes by the distance that its middle ray meets") {
    World description = world_with_robot(2, 2);
    Box box;
    box.name = "wall";
    box.x = 0.2;
    box.length = 0.1;
    box.width = 0.6;
    description.boxes.push_back(box);
    description.robots[0].x = 0.08;
    const auto reading = [&](const std::vector<ExtensionTerm>& terms) {
        World world = description;
        world.extension = terms;
        WorldModel model(world);
        for (int ms = 0; ms < 50; ++ms)
            model.step();
        return model.robot(0).channels()[kProximityChannel];
    };
    const double plain = reading({});
    REQUIRE(plain > 100);
    // The face is 0.15 - 0.08 - 0.03 = 0.04 m ahead of the sensor, seen at 17.2 degrees.
    const double away = 0.04 / std::cos(0.3002);
    CHECK(reading({term("proximity.reading", {{"distance", {0, 0.1}}}, {0, 1000})}) ==
          Approx(plain + away * 1e4).epsilon(0.01));
    CHECK(reading({term("proximity.reading", {{"angle", {0, 1}}}, {0, 100})}) ==
          Approx(plain + 30.02).epsilon(0.01));
}

TEST_CASE("what is wrong with a term is said, and with which key") {
    const auto problem = [](const ExtensionTerm& one) {
        const auto wrong = problem_of(one);
        return wrong ? wrong->key : std::string();
    };
    CHECK(problem(term("motion.turn", {{"speed", {0, 1}}}, {0, 1})).empty());
    CHECK(problem(term("motion.spin", {}, {0})) == "adds_to");
    CHECK(problem(term("motion.turn", {{"grey", {0, 1}}}, {0, 1})) == "over");
    CHECK(problem(term("motion.turn", {{"speed", {0, 1}}, {"speed", {0, 1}}}, {0, 1, 2, 3})) == "over");
    CHECK(problem(term("motion.turn", {{"speed", {0, 0}}}, {0, 1})) == "at");
    CHECK(problem(term("motion.turn", {{"speed", {1}}}, {0})) == "at");
    CHECK(problem(term("motion.turn", {{"speed", {0, 1}}}, {0, 1, 2})) == "value");
    CHECK(problem(term("motion.turn", {{"speed", {0, 1}}}, {0, 1e9})) == "value");
    CHECK(problem(term("motion.turn", {{"speed", {0, 1}}}, {0, NAN})) == "value");
    ExtensionTerm one = term("motion.turn", {}, {0.1});
    one.sensor = 1;
    CHECK(problem(one) == "sensor");
    one.sensor = -1;
    one.times = "grey";
    CHECK(problem(one) == "times");
    one.times = "speed";
    one.sd = {0.1, 0.2};
    CHECK(problem(one) == "sd");
    one.sd = {-0.1};
    CHECK(problem(one) == "sd");
    one.sd = {0.1};
    one.run_spread = -1;
    CHECK(problem(one) == "run_spread");
    one.run_spread = 0.1;
    CHECK(problem(one).empty());
}

TEST_CASE("a world with terms comes back from its text") {
    World world = world_with_robot();
    world.extension = {term("motion.turn", {{"speed", {0, 0.1}}, {"time", {0, 10}}}, {0, 1, 2, 3})};
    world.extension.front().sd = {0, 0, 0, 0.5};
    world.extension.front().times = "speed";
    world.extension.front().run_spread = 0.25;
    const World back = from_json(to_json(world));
    REQUIRE(back.extension.size() == 1);
    CHECK(back.extension.front().over[1].at == std::vector<double>{0, 10});
    CHECK(back.extension.front().sd == world.extension.front().sd);
    CHECK(back.extension.front().run_spread == 0.25);
    World bad = world;
    bad.extension.front().value.pop_back();
    CHECK_THROWS_WITH(check(bad),
                      Catch::Contains("extension") && Catch::Contains("3 values of a table of 4"));
}
