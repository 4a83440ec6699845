// Trails: what is laid, how it evaporates and spreads, what ground sensors see of it. Each against its
// formula.

#include "base/error.h"
#include "base/random.h"
#include "physics/sensors/pheromone.h"
#include "tests/physics/events/plans.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

World floor_with(const Pheromone& pheromone, double size = 0.4) {
    World world = world_with_robot(size, size);
    world.parameters = {{"ground.noise", 0}, {"ground.period", 0.001}};
    link_up(world);
    world.virtuals.pheromones.push_back(pheromone);
    return world;
}

double sum(const PheromoneField& field) {
    double all = 0.0;
    for (std::size_t row = 0; row < field.rows(); ++row)
        for (std::size_t column = 0; column < field.columns(); ++column)
            all += field.value(column, row);
    return all;
}

/// Mean square distance from a point of what lies there, along x.
double variance(const PheromoneField& field, double x) {
    double all = 0.0, moment = 0.0;
    for (std::size_t row = 0; row < field.rows(); ++row)
        for (std::size_t column = 0; column < field.columns(); ++column) {
            const double away = field.middle(column, row).x - x;
            all += field.value(column, row);
            moment += field.value(column, row) * away * away;
        }
    return moment / all;
}

}  // namespace

TEST_CASE("a trail covers the disc under the robot and fills in its time") {
    const Pheromone pheromone{.name = "trail", .radius = 0.03, .fill_time = 2.0, .half_life = 0.0};
    const World world = floor_with(pheromone);
    PheromoneField field(pheromone, world);
    CHECK(field.columns() == 40);
    CHECK(field.rows() == 40);
    field.lay(0.0, 0.0, 0.5);
    CHECK(field.strength(0.005, 0.005) == Approx(0.25));
    CHECK(field.strength(0.06, 0.0) == 0.0);
    field.lay(0.0, 0.0, 5.0);
    CHECK(field.strength(0.005, 0.005) == 1.0);
    field.pass(100'000);
    CHECK(field.strength(0.005, 0.005) == 1.0);
    // In small squares the disc's area is that of the disc.
    Pheromone fine = pheromone;
    fine.cell = 0.002;
    PheromoneField disc(fine, floor_with(fine));
    disc.lay(0.0103, -0.0217, 9.0);
    CHECK(sum(disc) * fine.cell * fine.cell == Approx(3.14159 * 0.03 * 0.03).epsilon(0.01));
}

TEST_CASE("half of a trail is left after its half-life") {
    const Pheromone pheromone{.name = "trail", .half_life = 7.0};
    PheromoneField field(pheromone, floor_with(pheromone));
    field.lay(0.0, 0.0, 1.0);
    const double before = sum(field);
    for (int i = 0; i < 700; ++i)
        field.pass(10);
    CHECK(sum(field) == Approx(before / 2).epsilon(1e-9));
    for (int i = 0; i < 40; ++i)
        field.pass(7000);
    CHECK(sum(field) == 0.0);
}

TEST_CASE("a trail spreads as diffusion does, and nothing of it is lost at walls") {
    const double rate = GENERATE(2e-5, 4e-4);  // m2/s: one step at a time, and several
    const Pheromone pheromone{.name = "trail", .radius = 0.01, .half_life = 0.0, .diffusion = rate};
    PheromoneField field(pheromone, floor_with(pheromone, 0.6));
    field.lay(0.0, 0.0, 1.0);
    const double before = sum(field), narrow = variance(field, 0.0);
    constexpr double kSeconds = 2.0;
    field.pass(2000);
    CHECK(sum(field) == Approx(before));
    // The variance of what diffuses in the open grows by 2 D t.
    CHECK(variance(field, 0.0) - narrow == Approx(2 * rate * kSeconds).epsilon(0.02));
    for (int i = 0; i < 500; ++i)
        field.pass(1000);
    CHECK(sum(field) == Approx(before));
    if (rate > 1e-4) CHECK(field.strength(0.25, 0.25) == Approx(before / 3600).epsilon(0.02));
}

TEST_CASE("nothing is laid outside the arena, whatever its shape") {
    const Pheromone pheromone{.name = "trail", .radius = 0.1, .half_life = 0.0, .diffusion = 1e-4};
    World world = floor_with(pheromone);
    world.arena.corners = {{-0.2, -0.2}, {0.2, -0.2}, {0.2, 0.2}};  // half of the square
    world.robots.clear();
    PheromoneField field(pheromone, world);
    field.lay(0.0, 0.0, 1.0);
    field.lay(-5.0, 9.0, 1.0);
    const double before = sum(field);
    field.pass(20'000);
    CHECK(field.strength(-0.1, 0.1) == 0.0);
    CHECK(field.strength(0.15, -0.1) > 0.0);
    CHECK(sum(field) == Approx(before));
}

TEST_CASE("what robots lay is what their ground sensors see, and what others see later") {
    World world = floor_with({.name = "trail", .radius = 0.06, .fill_time = 0.1, .half_life = 1.0});
    WorldModel model(world);
    const auto centre = [&] { return model.robot(0).channels()[kGroundChannel + 1]; };
    model.step();
    const double white = centre();
    for (int i = 0; i < 200; ++i)
        model.step();
    const double black = centre();
    CHECK(black < white - 300);
    // As a black floor, by the share that is there.
    CHECK(model.robot(0).greys()[1] ==
          Approx(1.0 - model.trails()[0].strength(model.parameters().ground.x, 0.0)));
    // It stands still; what it does not lay any more evaporates, and it sees that.
    World late = world;
    late.virtuals.pheromones[0].led = "led0";
    WorldModel lit(late);
    lit.board_signal(0, kLedId, 1.0);
    for (int i = 0; i < 200; ++i)
        lit.step();
    CHECK(lit.robot(0).channels()[kGroundChannel + 1] == black);
    lit.board_signal(0, kLedId, 0.0);
    for (int i = 0; i < 1000; ++i)
        lit.step();
    CHECK(lit.robot(0).greys()[1] == Approx(0.5).margin(0.02));
    CHECK(lit.robot(0).channels()[kGroundChannel + 1] > black + 100);
}

TEST_CASE("only those who are named lay, and nobody whose LED is dark") {
    World world = floor_with({.name = "trail", .robots = {"nobody"}});
    CHECK_THROWS_WITH(check(world), Catch::Contains("pheromone 'trail': there is no robot 'nobody'"));
    world.virtuals.pheromones[0] = {.name = "trail", .led = "led0"};
    WorldModel model(world);
    for (int i = 0; i < 100; ++i)
        model.step();
    CHECK(sum(model.trails()[0]) == 0.0);
}

TEST_CASE("a trail that no machine could compute is refused") {
    World world = floor_with({.name = "trail", .cell = 0.001}, 2.0);
    CHECK_THROWS_WITH(check(world), Catch::Contains("2000 x 2000 squares"));
    world = floor_with({.name = "trail", .diffusion = 1.0});
    CHECK_THROWS_WITH(check(world), Catch::Contains("diffusion"));
    for (const double wrong : {-1.0, 0.001, std::nan("")}) {
        world = floor_with({.name = "trail", .half_life = wrong});
        CHECK_THROWS_AS(check(world), InputError);
    }
}

TEST_CASE("strength lies between that of the squares around, at drawn places") {
    const Pheromone pheromone{.name = "trail", .radius = 0.05, .half_life = 0.0, .diffusion = 1e-4};
    PheromoneField field(pheromone, floor_with(pheromone));
    RandomStream random(38, "pheromone");
    const auto place = [&] { return 0.5 * random.uniform() - 0.25; };
    for (int i = 0; i < 20; ++i)
        field.lay(place(), place(), 0.05);
    field.pass(500);
    for (int i = 0; i < 2000; ++i) {
        const double x = place(), y = place();
        const double here = field.strength(x, y);
        CHECK(here >= 0.0);
        CHECK(here <= 1.0);
        CHECK(std::abs(field.strength(x + 1e-5, y) - here) < 0.002);  // no jumps
    }
}
