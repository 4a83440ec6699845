// What hands do to a world, as bodies feel and sensors see it.

#include "base/error.h"
#include "base/random.h"
#include "physics/events/scene.h"
#include "tests/physics/events/plans.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

struct Stage {
    WorldModel model;
    Scene scene;
    Driver driver;
    explicit Stage(const World& world) : model(world), scene(model), driver(model) {}

    std::string act(const Action& action) { return scene.apply(action); }
    void wait(double seconds) {
        for (int i = 0; i < static_cast<int>(seconds * 1e3); ++i) {
            model.move_bodies();
            scene.glide();
            model.sense();
        }
    }
    double channel(std::size_t index) const { return model.robot(0).channels()[index]; }
};

World room() {
    World world = world_with_robot(1.0, 1.0);
    world.boxes.push_back({.name = "crate", .x = 0.3, .y = 0.3, .length = 0.1, .width = 0.1});
    world.boxes.push_back({.name = "parcel",
                           .x = -0.3,
                           .y = -0.3,
                           .length = 0.06,
                           .width = 0.06,
                           .height = 0.06,
                           .movable = true,
                           .mass = 0.02});
    world.lamps.push_back({.name = "sun", .x = 0.3, .y = -0.2});
    return world;
}

Action set(const std::string& object, const std::string& property, double value) {
    Action result = action(Verb::Set, object);
    result.property = property;
    result.value = value;
    return result;
}

}  // namespace

TEST_CASE("a box that is put before the robot is seen at the next look, and its absence too") {
    Stage stage(room());
    stage.wait(0.01);
    const double nothing = stage.channel(kProximityChannel);
    REQUIRE(stage.act(move_to("crate", 0.1, 0.0)).empty());
    stage.wait(0.002);
    const double seen = stage.channel(kProximityChannel);
    CHECK(seen > nothing + 300.0);
    // As if it had stood there from the start.
    World there = room();
    there.boxes[0].x = 0.1;
    there.boxes[0].y = 0.0;
    Stage other(there);
    other.wait(0.002);
    CHECK(seen == Approx(other.channel(kProximityChannel)).margin(0.01));
    REQUIRE(stage.act(set("crate", "reflectivity", 0.3)).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kProximityChannel) < nothing + 0.5 * (seen - nothing));
    REQUIRE(stage.act(action(Verb::Remove, "crate")).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kProximityChannel) == nothing);
    CHECK(stage.act(move_to("crate", 0.2, 0.0)) == "there is no 'crate' in this world");
    Action again = action(Verb::Add, "crate");
    again.thing.boxes.push_back({.name = "crate", .x = 0.1, .y = 0.0, .length = 0.1, .width = 0.1});
    REQUIRE(stage.act(again).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kProximityChannel) == Approx(seen).margin(0.01));
}

TEST_CASE("a robot drives against what was put in its way and on when it is taken away") {
    Stage stage(room());
    REQUIRE(stage.act(move_to("crate", 0.15, 0.0)).empty());
    stage.driver.drive(800, 800, 2.0);
    const double stopped = stage.model.state(0).x;
    CHECK(stopped == Approx(0.10 - 0.037).margin(0.003));
    REQUIRE(stage.act(action(Verb::Remove, "crate")).empty());
    stage.driver.drive(800, 800, 2.0);
    CHECK(stage.model.state(0).x > stopped + 0.15);
}

TEST_CASE("things glide evenly, push what is in their way, and arrive") {
    Stage stage(room());
    Action glide = move_to("parcel", 0.1, -0.3, 2.0);
    glide.heading = 1.0;
    REQUIRE(stage.act(glide).empty());
    stage.wait(1.0);
    CHECK(stage.model.object(0).x == Approx(-0.1).margin(0.002));
    CHECK(stage.model.object(0).heading == Approx(0.5).margin(0.01));
    stage.wait(1.0);
    CHECK(stage.model.object(0).x == Approx(0.1).margin(1e-4));
    stage.wait(1.0);
    CHECK(stage.model.object(0).x == Approx(0.1).margin(1e-3));
    // A fixed box pushes the robot before it.
    REQUIRE(stage.act(move_to("crate", -0.15, 0.0)).empty());
    REQUIRE(stage.act(move_to("crate", 0.05, 0.25, 0.0)).empty());
    REQUIRE(stage.act(move_to("crate", -0.3, 0.0)).empty());
    REQUIRE(stage.act(move_to("crate", -0.095, 0.0, 3.0)).empty());
    stage.wait(3.2);
    CHECK(stage.model.state(0).x > -0.045 + 0.036);
}

TEST_CASE("a robot's ground sensors see a grey that is not there, for itself alone, until they see the floor "
          "again") {
    World world = room();
    world.robots.push_back(robot_at("e2", 0.0, 0.3, 0.0));
    Stage stage(world);
    stage.driver.drive(0, 0, 0.2);
    const double floor = stage.channel(kGroundChannel);
    const double floor_of_other = stage.model.robot(1).channels()[kGroundChannel];
    CHECK(stage.act(action(Verb::Unset, "e1")) ==
          "'e1' sees the floor as it is (expected set e1 ground GREY before)");
    Action set = action(Verb::Set, "e1");
    set.property = "ground";
    set.value = 0.0;
    REQUIRE(stage.act(set).empty());
    stage.driver.drive(300, 300, 0.2);  // wherever it drives
    CHECK(stage.channel(kGroundChannel) < 0.6 * floor);
    CHECK(stage.model.robot(1).channels()[kGroundChannel] == Approx(floor_of_other).epsilon(0.05));
    // As over black paper: the sensors' own law.
    World black = room();
    black.arena.floor_grey = 0.0;
    Stage over_black(black);
    over_black.driver.drive(0, 0, 0.2);
    CHECK(stage.channel(kGroundChannel) == Approx(over_black.channel(kGroundChannel)).epsilon(0.05));
    set.value = 1.5;
    CHECK(stage.act(set) == "ground = 1.5 is out of range (expected 0 to 1)");
    REQUIRE(stage.act(action(Verb::Unset, "e1")).empty());
    stage.driver.drive(0, 0, 0.2);
    CHECK(stage.channel(kGroundChannel) == Approx(floor).epsilon(0.05));
}

TEST_CASE("a lifted robot hangs still, its wheels turn, nothing is under or around it") {
    World world = room();
    world.robots.push_back(robot_at("e2", 0.0, 0.09, 0.0));
    Stage stage(world);
    stage.driver.drive(0, 0, 0.2);
    const double ground = stage.channel(kGroundChannel);
    const double beside = stage.channel(kProximityChannel + 5);
    CHECK(ground > 300.0);
    const double seen_by_other = stage.model.robot(1).channels()[kProximityChannel + 2];
    REQUIRE(stage.act(action(Verb::Lift, "e1")).empty());
    CHECK(stage.act(action(Verb::Lift, "e1")) == "'e1' is in the air already");
    const auto before = stage.model.state(0);
    stage.driver.drive(800, -600, 1.0);
    const auto& held = stage.model.state(0);
    CHECK(std::hypot(held.x - before.x, held.y - before.y) < 1e-4);
    CHECK(std::abs(held.heading - before.heading) < 1e-3);
    CHECK(held.wheel[0] - before.wheel[0] == Approx(0.8 * 2 * 3.14159265).epsilon(0.02));
    CHECK(held.wheel[1] - before.wheel[1] == Approx(-0.6 * 2 * 3.14159265).epsilon(0.02));
    CHECK(stage.channel(kGroundChannel) < 0.1 * ground);
    CHECK(stage.channel(kProximityChannel + 5) < beside - 50);
    CHECK(stage.model.robot(1).channels()[kProximityChannel + 2] <
          seen_by_other - 50);  // nor does the other see it
    // Where it was is free while it hangs there.
    REQUIRE(stage.act(move_to("e2", 0.0, 0.0)).empty());
    CHECK(stage.act(action(Verb::Put, "e1")) == "(0 m, 0 m) is taken by 'e2'");
    Action put = action(Verb::Put, "e1");
    put.to = Point{-0.2, 0.2};
    put.heading = 1.5;
    REQUIRE(stage.act(put).empty());
    stage.driver.drive(0, 0, 0.3);
    const auto& down = stage.model.state(0);
    CHECK(down.x == Approx(-0.2).margin(1e-3));
    CHECK(down.y == Approx(0.2).margin(1e-3));
    CHECK(down.heading == Approx(1.5).margin(5e-3));
    CHECK(stage.channel(kGroundChannel) == Approx(ground).epsilon(0.05));
    stage.driver.drive(800, 800, 1.0);
    CHECK(stage.model.state(0).y - 0.2 > 0.09);
}

TEST_CASE("a robot is carried over what stands between, and drives on where it is put") {
    Stage stage(room());
    REQUIRE(stage.act(move_to("e1", 0.42, 0.42, 1.0)).empty());  // over the crate
    stage.driver.drive(0, 0, 0.5);
    stage.wait(0.5);
    CHECK(stage.model.robot(0).lifted());
    stage.wait(0.6);
    CHECK_FALSE(stage.model.robot(0).lifted());
    CHECK(stage.model.state(0).x == Approx(0.42).margin(1e-3));
    stage.driver.drive(-400, -400, 0.2);
    CHECK(stage.model.state(0).x < 0.415);
    CHECK(stage.act(move_to("e1", 0.49, 0.0)) ==
          "(0.49 m, 0 m) is too close to the arena's wall: it would be in it");
}

TEST_CASE("lamps, room light, floor and battery change what sensors read") {
    Stage stage(room());
    stage.wait(0.2);
    const double lit = stage.channel(kAmbientChannel);
    REQUIRE(stage.act(action(Verb::SwitchOff, "sun")).empty());
    stage.wait(0.002);
    const double off = stage.channel(kAmbientChannel);
    CHECK(off > lit + 5);
    REQUIRE(stage.act(action(Verb::SwitchOn, "sun")).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kAmbientChannel) == lit);
    REQUIRE(stage.act(action(Verb::Remove, "sun")).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kAmbientChannel) == off);
    REQUIRE(stage.act(set("light", "ambient", 0.0)).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kAmbientChannel) > off + 50);
    const double white = stage.channel(kGroundChannel);
    REQUIRE(stage.act(set("floor", "grey", 0.0)).empty());
    stage.wait(0.2);
    const double black = stage.channel(kGroundChannel);
    CHECK(black < 0.6 * white);
    Action add = action(Verb::Add, "sheet");
    add.thing.patches.push_back({.name = "sheet", .length = 0.2, .width = 0.2, .grey = 1.0});
    REQUIRE(stage.act(add).empty());
    stage.wait(0.2);
    CHECK(stage.channel(kGroundChannel) == Approx(white).margin(20));
    REQUIRE(stage.act(set("sheet", "grey", 0.0)).empty());
    stage.wait(0.2);
    CHECK(stage.channel(kGroundChannel) == Approx(black).margin(20));
    REQUIRE(stage.act(set("e1", "charge", 0.02)).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kBatteryVoltageChannel) < 3.4);
    CHECK(stage.channel(kBatteryLowChannel) == 1.0);
    CHECK(stage.act(set("floor", "ambient", 1.0)) == "the floor has no ambient (expected grey)");
    CHECK(stage.act(set("sheet", "charge", 0.5)) == "'sheet' has no charge");
    CHECK(stage.act(set("light", "ambient", 1000.0)) == "ambient = 1000 is out of range (expected 0 to 100)");
}

TEST_CASE("a loudspeaker that is added is heard until it is switched off or taken away") {
    Stage stage(room());
    stage.wait(0.01);
    CHECK(stage.channel(kMicrophoneChannel) == 0.0);
    Action add = action(Verb::Add, "horn");
    add.thing.speakers.push_back({.name = "horn", .x = 0.1, .level = 500.0});
    REQUIRE(stage.act(add).empty());
    stage.wait(0.002);
    const double loud = stage.channel(kMicrophoneChannel);
    CHECK(loud > 50.0);
    REQUIRE(stage.act(action(Verb::SwitchOff, "horn")).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kMicrophoneChannel) == 0.0);
    REQUIRE(stage.act(action(Verb::SwitchOn, "horn")).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kMicrophoneChannel) == loud);
    REQUIRE(stage.act(action(Verb::Remove, "horn")).empty());
    stage.wait(0.002);
    CHECK(stage.channel(kMicrophoneChannel) == 0.0);
}

TEST_CASE("whatever hands do, in whatever order, the world goes on (seeded)") {
    World world = room();
    world.robots.push_back(robot_at("e2", -0.2, 0.2, 1.0));
    world.speakers.push_back({.name = "horn", .x = 0.1, .level = 100.0});
    world.patches.push_back({.name = "sheet", .length = 0.2, .width = 0.2, .grey = 0.2});
    Stage stage(world);
    RandomStream random(20, "hands");
    const std::vector<std::string> names{"e1",    "e2", "crate", "parcel", "sun", "horn",
                                         "sheet", "n0", "n1",    "n2",     "n3"};
    const auto metres = [&] { return random.uniform() - 0.5; };
    const auto added = [&](const std::string& name) {
        Action add = action(Verb::Add, name);
        const double x = metres(), y = metres();
        const bool movable = random.below(2) == 0;
        switch (random.below(6)) {
        case 0:
            add.thing.boxes.push_back({.name = name,
                                       .x = x,
                                       .y = y,
                                       .heading = x * 6,
                                       .length = 0.05,
                                       .width = 0.08,
                                       .movable = movable,
                                       .mass = 0.05});
            break;
        case 1:
            add.thing.cylinders.push_back({.name = name, .x = x, .y = y, .radius = 0.03, .movable = movable});
            break;
        case 2:
            add.thing.walls.push_back({.name = name, .from = {x, y}, .to = {y, 0.1}});
            break;
        case 3:
            add.thing.lamps.push_back({.name = name, .x = x, .y = y});
            break;
        case 4:
            add.thing.speakers.push_back({.name = name, .x = x, .y = y, .level = 50.0});
            break;
        default:
            add.thing.patches.push_back({.name = name, .x = x, .y = y, .grey = 0.5});
        }
        return add;
    };
    int done = 0;
    for (int i = 0; i < 10'000; ++i) {
        const auto verb = static_cast<Verb>(random.below(8));
        Action what = verb == Verb::Add ? added(names[7 + random.below(4)])
                                        : action(verb, names[random.below(names.size())]);
        if (verb == Verb::Move || (verb == Verb::Put && random.below(2) == 0)) {
            what.to = Point{metres(), metres()};
            if (random.below(2) == 0) what.heading = metres() * 20;
            if (verb == Verb::Move && random.below(3) == 0)
                what.over = 0.005 * static_cast<double>(random.below(20));
        }
        if (verb == Verb::Set)
            what = set(what.object, random.below(2) == 0 ? "reflectivity" : "grey", random.uniform());
        done += stage.act(what).empty() ? 1 : 0;
        stage.driver.feed(random.below(2) == 0 ? 600 : -900, 500);
        stage.wait(0.004);
        for (std::size_t robot = 0; robot < 2; ++robot) {
            for (const double value : stage.model.robot(robot).channels())
                REQUIRE(std::isfinite(value));
            REQUIRE(std::abs(stage.model.state(robot).x) < 0.6);
            REQUIRE(std::abs(stage.model.state(robot).pitch) < 0.5);
        }
    }
    CHECK(done > 1000);
    CHECK(stage.model.dynamics().ode_warnings() == 0);
}
