// Things that only robots sense: as real ones for the sensor they are for, as none for everything else.

#include "base/error.h"
#include "physics/events/scene.h"
#include "tests/physics/events/plans.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

World quiet_room() {
    World world = world_with_robot(1.0, 1.0);
    world.parameters = {{"ground.noise", 0}, {"ground.period", 0.001}};
    link_up(world);
    return world;
}

Virtual<Box> ghost(double x, std::vector<std::string> robots = {}) {
    Virtual<Box> box;
    static_cast<Box&>(box) = {.name = "ghost", .x = x, .length = 0.1, .width = 0.1};
    box.robots = std::move(robots);
    return box;
}

Box crate(double x) {
    return {.name = "crate", .x = x, .length = 0.1, .width = 0.1};
}

double front(const World& world, std::size_t robot = 0) {
    WorldModel model(world);
    for (int i = 0; i < 5; ++i)
        model.step();
    return model.robot(robot).channels()[kProximityChannel];
}

}  // namespace

TEST_CASE("a virtual box reads as a real one to proximity sensors") {
    World real = quiet_room(), virtual_one = quiet_room();
    real.boxes.push_back(crate(0.1));
    virtual_one.virtuals.boxes.push_back(ghost(0.1));
    CHECK(front(virtual_one) == front(real));
    CHECK(front(real) > front(quiet_room()) + 300);
}

TEST_CASE("a robot drives through a virtual box") {
    World world = quiet_room();
    world.virtuals.boxes.push_back(ghost(0.15));
    WorldModel with(world), without(quiet_room());
    Driver first(with), second(without);
    first.drive(800, 800, 2.0);
    second.drive(800, 800, 2.0);
    CHECK(with.state(0).x == without.state(0).x);
    CHECK(with.state(0).x > 0.15);
}

TEST_CASE("only the robots that are named sense a virtual thing") {
    World world = quiet_room();
    Robot other = world.robots[0];
    other.name = "other";
    other.y = 0.3;
    world.robots.push_back(other);
    const double nothing = front(world, 0);
    world.virtuals.walls.emplace_back();
    auto& wall = world.virtuals.walls.back();
    wall.name = "line";
    wall.from = {0.06, -0.45};
    wall.to = {0.06, 0.45};
    CHECK(front(world, 0) > nothing + 250);
    CHECK(front(world, 1) > nothing + 250);
    wall.robots = {"other"};
    CHECK(front(world, 0) == nothing);
    CHECK(front(world, 1) > nothing + 250);
    wall.robots = {"nobody"};
    CHECK_THROWS_WITH(check(world), Catch::Contains("virtual_wall 'line': there is no robot 'nobody'"));
}

TEST_CASE("a virtual lamp shines on light sensors as a real one, and casts no light elsewhere") {
    World real = quiet_room(), virtual_one = quiet_room();
    real.lamps.push_back({.name = "sun", .x = 0.2, .y = 0.1});
    virtual_one.virtuals.lamps.emplace_back();
    static_cast<Lamp&>(virtual_one.virtuals.lamps[0]) = real.lamps[0];
    WorldModel first(real), second(virtual_one), dark(quiet_room());
    for (int i = 0; i < 3; ++i)
        for (WorldModel* model : {&first, &second, &dark})
            model->step();
    bool any = false;
    for (std::size_t i = 0; i < kProximitySensors; ++i) {
        CHECK(second.robot(0).channels()[kAmbientChannel + i] ==
              first.robot(0).channels()[kAmbientChannel + i]);
        any = any || second.robot(0).channels()[kAmbientChannel + i] !=
                         dark.robot(0).channels()[kAmbientChannel + i];
    }
    CHECK(any);
    CHECK(second.description().lamps.empty());
    virtual_one.virtuals.lamps[0].robots = {"nobody"};
    CHECK_THROWS_AS(check(virtual_one), InputError);
}

TEST_CASE("virtual things come, move, change and go while the world runs") {
    WorldModel model(quiet_room());
    Scene scene(model);
    const auto reading = [&] {
        model.step();
        model.step();
        return model.robot(0).channels()[kProximityChannel];
    };
    const double nothing = reading();
    Action add = action(Verb::Add, "ghost");
    add.thing.virtuals.boxes.push_back(ghost(0.1));
    REQUIRE(scene.apply(add).empty());
    const double near = reading();
    CHECK(near > nothing + 300);
    CHECK(scene.apply(add) == "there already is a 'ghost'");
    // Into a wall, and onto a robot: nothing is in its way.
    REQUIRE(scene.apply(move_to("ghost", 0.5, 0.0)).empty());
    CHECK(reading() == nothing);
    REQUIRE(scene.apply(move_to("ghost", 0.1, 0.0)).empty());
    CHECK(reading() == Approx(near));
    Action dull = action(Verb::Set, "ghost");
    dull.property = "reflectivity";
    dull.value = 0.1;
    REQUIRE(scene.apply(dull).empty());
    CHECK(reading() < nothing + 0.5 * (near - nothing));
    REQUIRE(scene.apply(action(Verb::Remove, "ghost")).empty());
    CHECK(reading() == nothing);
    Action wrong = action(Verb::Add, "line");
    wrong.thing.virtuals.walls.emplace_back();
    wrong.thing.virtuals.walls.back().name = "line";
    wrong.thing.virtuals.walls.back().to = {0.1, 0.0};
    wrong.thing.virtuals.walls.back().robots = {"nobody"};
    CHECK_THAT(scene.apply(wrong), Catch::Contains("there is no robot 'nobody'"));
}

TEST_CASE("hands do nothing to a trail, and say why") {
    World world = quiet_room();
    world.virtuals.pheromones.push_back({.name = "trail"});
    WorldModel model(world);
    Scene scene(model);
    for (const Action& what :
         {move_to("trail", 0, 0), action(Verb::Remove, "trail"), action(Verb::Lift, "trail")})
        CHECK(scene.apply(what) == "'trail' is a pheromone, which lies where it was laid");
}

TEST_CASE("virtual things survive the way to the world's process") {
    World world = quiet_room();
    world.virtuals.boxes.push_back(ghost(0.1, {world.robots[0].name}));
    world.virtuals.pheromones.push_back({.name = "trail", .led = "led0", .half_life = 3.0});
    const World again = from_json(to_json(world));
    REQUIRE(again.virtuals.boxes.size() == 1);
    CHECK(again.virtuals.boxes[0].x == 0.1);
    CHECK(again.virtuals.boxes[0].robots == world.virtuals.boxes[0].robots);
    CHECK(again.virtuals.pheromones[0].led == "led0");
    CHECK(again.virtuals.pheromones[0].half_life == 3.0);
}
