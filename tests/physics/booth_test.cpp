// The booth of a TAM: its beams against a plain look along many lines, its walls, what its node sends.

#include "base/error.h"
#include "base/random.h"
#include "physics/description/booth.h"
#include "physics/node/world_node.h"
#include "physics/world/booth_record.h"
#include "tests/kit/scratch.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <optional>
#include <sstream>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

Booth booth_at(double x, double y, double heading) {
    Booth booth;
    booth.name = "tam0";
    booth.x = x;
    booth.y = y;
    booth.heading = heading;
    return booth;
}

/// Share of the beam that is dark, by lines from shell to shell, each looked along with chord().
double by_lines(const Booth& booth, std::size_t beam, const std::vector<Shape>& bodies) {
    constexpr int kLines = 4000;
    constexpr double kGap = booth::kSize - 2 * booth::kShell;
    const double dx = -std::sin(booth.heading), dy = std::cos(booth.heading);
    int dark = 0;
    for (int i = 0; i < kLines; ++i) {
        const double across = ((i + 0.5) / kLines - 0.5) * booth::kBeamWidth;
        const Point from = from_booth(booth, booth::kBeam[beam] + across, -kGap / 2);
        bool hit = false;
        for (const Shape& body : bodies)
            if (const auto c = chord(body, from.x, from.y, dx, dy); c && body.height > booth::kBeamHeight)
                hit |= c->out > 0 && c->in < kGap;
        dark += hit ? 1 : 0;
    }
    return static_cast<double>(dark) / kLines;
}

World booth_world(double robot_x) {
    World world;
    world.arena = rectangular_arena(1.0, 1.0);
    world.booths.push_back(booth_at(0.2, 0.1, 0.0));
    world.robots.push_back(robot_at("e1", robot_x, 0.1, std::numbers::pi));
    return world;
}

}  // namespace

TEST_CASE("beams are interrupted as far as bodies shade them") {
    RandomStream random(1, "booth");
    int partly = 0, wholly = 0;
    for (int i = 0; i < 3000; ++i) {
        const Booth booth = booth_at(random.uniform() - 0.5, random.uniform() - 0.5, 7 * random.uniform());
        const BoothModel model(booth);
        std::vector<Shape> bodies;
        for (std::uint64_t n = 1 + random.below(3); n > 0; --n) {
            const Point at =
                from_booth(booth, 0.3 * (random.uniform() - 0.5), 0.2 * (random.uniform() - 0.5));
            const double height = random.below(5) == 0 ? 0.004 : 0.05;
            const double size = 0.002 + 0.05 * random.uniform();
            bodies.push_back(random.below(2) == 0 ? circle_shape(at.x, at.y, size, height, 1.0)
                                                  : box_shape(at.x, at.y, 7 * random.uniform(), 2 * size,
                                                              0.002 + 0.05 * random.uniform(), height, 1.0));
        }
        std::vector<const Shape*> view;
        for (const Shape& body : bodies)
            view.push_back(&body);
        const auto shares = model.interrupted(view);
        for (std::size_t beam = 0; beam < shares.size(); ++beam) {
            INFO("case " << i << ", beam " << beam);
            CHECK(shares[beam] == Approx(by_lines(booth, beam, bodies)).margin(1.5e-3));
            partly += shares[beam] > 0.01 && shares[beam] < 0.99 ? 1 : 0;
            wholly += shares[beam] >= 0.99 ? 1 : 0;
        }
    }
    CHECK(partly > 50);
    CHECK(wholly > 500);
}

TEST_CASE("a robot drives in until the back stops it, and the beams follow it to a tenth of a millimetre") {
    World world = booth_world(0.36);
    WorldModel model(world);
    Driver driver(model);
    const double radius = model.robot(0).body().radius;
    std::array<double, 2> first{}, last{};  // where a beam was first half dark, and half free again
    for (int step = 0; step < 4000; ++step) {
        const auto before = model.booth(0).barriers;
        driver.feed(500, 500);
        model.step();
        const double x = model.state(0).x - 0.2;
        for (std::size_t beam = 0; beam < 2; ++beam) {
            const double now = model.booth(0).barriers[beam];
            CHECK(std::abs(now - before[beam]) < 0.1);  // 0.13 mm of 2 mm
            if (before[beam] <= 0.5 && now > 0.5) first[beam] = x;
            if (before[beam] > 0.5 && now <= 0.5) last[beam] = x;
        }
    }
    for (std::size_t beam = 0; beam < 2; ++beam)
        CHECK(first[beam] == Approx(booth::kBeam[beam] + radius).margin(2e-4));
    CHECK(last[0] == Approx(booth::kBeam[0] - radius).margin(2e-4));
    // Inside: the front is free, the back is not, and the body is at the diffuser.
    CHECK(model.booth(0).barriers[0] == 0.0);
    CHECK(model.booth(0).barriers[1] == 1.0);
    CHECK(model.state(0).x - 0.2 == Approx(booth::kBack + radius).margin(1e-3));
    // The sides are seen by the proximity sensors, which look over the bumpers.
    CHECK(model.robot(0).channels()[2] > 100);
    CHECK(model.robot(0).channels()[5] > 100);
}

TEST_CASE("a robot that is too far aside stops at a side's edge and interrupts nothing") {
    World world = booth_world(0.36);
    world.robots[0].y += 0.055;
    WorldModel model(world);
    Driver driver(model);
    driver.drive(500, 500, 3);
    CHECK(model.state(0).x - 0.2 > booth::kSize / 2);
}

TEST_CASE("a booth that cannot stand there is refused with its line") {
    const auto refused = [](World world) {
        try {
            check(world);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    World world = booth_world(0.36);
    CHECK(refused(world).empty());
    World in_wall = world;
    in_wall.booths[0].x = 0.45;
    CHECK_THAT(refused(in_wall), Catch::Contains("tam 'tam0'") && Catch::Contains("arena's wall"));
    World against_wall = world;
    against_wall.booths[0].x = 0.44;
    against_wall.robots[0].x = 0.0;
    CHECK(refused(against_wall).empty());
    World outside = world;
    outside.booths[0].x = 0.7;
    CHECK_THAT(refused(outside), Catch::Contains("outside the arena"));
    World both = world;
    both.booths.push_back(booth_at(0.25, 0.15, 1.0));
    both.booths[1].name = "tam1";
    CHECK_THAT(refused(both), Catch::Contains("overlaps tam 'tam0'"));
    World same_name = world;
    same_name.booths[0].name = "e1";
    CHECK_THAT(refused(same_name), Catch::Contains("already taken"));
    World robot_in_side = world;
    robot_in_side.robots[0].x = 0.2;
    robot_in_side.robots[0].y = 0.155;
    CHECK_THAT(refused(robot_in_side), Catch::Contains("overlaps tam 'tam0'"));
    World robot_inside = world;
    robot_inside.robots[0].x = 0.21;
    CHECK(refused(robot_inside).empty());
}

TEST_CASE("the world's node publishes beams a step later, and its lights shine as the board drives them") {
    World world = booth_world(0.21);  // stands in the booth
    world.booths[0].signals = {
        {"barrier_front", 0}, {"barrier_back", 1}, {"led_top_red", 29}, {"led_left_blue", 22}};
    WorldNode node(world);
    REQUIRE(node.ports().size() == 3);
    CHECK(node.ports()[2].name == "tam0");
    std::vector<cosim::Message> outbox;
    node.advance(cosim::kMillisecond / 2, {}, outbox);
    std::vector<cosim::Message> beams;
    for (const auto& message : outbox)
        if (message.port == 2) beams.push_back(message);
    REQUIRE(beams.size() == 1);
    CHECK(beams[0].time == cosim::kMillisecond);
    CHECK(std::get<cosim::Signal>(beams[0].payload) == cosim::Signal{1, 1.0});
    outbox.clear();
    const cosim::Message lit[] = {{cosim::kMillisecond, 2, cosim::Signal{29, 0.25}},
                                  {cosim::kMillisecond, 2, cosim::Signal{22, 0.5}},
                                  {cosim::kMillisecond, 2, cosim::Signal{5, 1.0}}};
    node.advance(5 * cosim::kMillisecond, lit, outbox);
    for (const auto& message : outbox)
        CHECK(message.port != 2);  // nothing has moved
}

TEST_CASE("lights are where the booth has them, and go out") {
    const Booth booth = booth_at(1.0, 2.0, std::numbers::pi / 2);
    BoothModel model(booth);
    model.shine(3, 0, 0.5);
    model.shine(0, 2, 2.0);
    const auto lights = model.lights();
    CHECK(lights[3].red == 0.5);
    CHECK(lights[3].lit());
    CHECK(lights[0].blue == 1.0);
    CHECK_FALSE(lights[1].lit());
    // The top light is 5 cm behind the middle; the opening looks north.
    CHECK(lights[3].x == Approx(1.0));
    CHECK(lights[3].y == Approx(1.95));
    CHECK(lights[3].z == Approx(0.113));
    CHECK(lights[2].x == Approx(0.975));  // left of north is west
    model.dark();
    for (const ColouredLight& light : lights)
        CHECK_FALSE(light.lit());
}

TEST_CASE("no event moves a booth or a part of it") {
    World world = booth_world(0.36);
    EventPlan plan;
    Event& event = plan.events.emplace_back();
    event.action.to = Point{0.0, 0.0};
    event.action.object = "tam0";
    CHECK_THROWS_WITH(check_events(plan, world), Catch::Contains("'tam0' is a TAM"));
    event.action.object = "tam0 back";
    CHECK_THROWS_WITH(check_events(plan, world), Catch::Contains("there is no 'tam0 back'"));
}

TEST_CASE("tams.csv is read back, and damage is named or ignored") {
    const auto file = puckloop::tests::scratch_path("puckloop-tams.csv");
    WorldModel model(booth_world(0.36));
    {
        BoothRecord record(file.string(), model);
        for (int i = 0; i < 30; ++i) {
            model.booth(0).shine(static_cast<std::size_t>(i % 4), static_cast<std::size_t>(i % 3), i / 30.0);
            model.step();
            record.after_step(model);
        }
    }
    std::ostringstream whole;
    whole << std::ifstream(file).rdbuf();
    const auto good = read_booth_colours(file);
    REQUIRE(good.size() == 1);
    CHECK(good[0].colours.size() == 30);  // the first step shone no brighter
    RandomStream random(2, "tams.csv");
    int named = 0;
    for (int i = 0; i < 400; ++i) {
        std::string text = whole.str();
        for (std::uint64_t n = 1 + random.below(3); n > 0; --n) {
            const std::size_t at = random.below(text.size());
            if (random.below(3) == 0)
                text.erase(at, 1 + random.below(200));
            else
                text[at] = static_cast<char>(random.below(256));
        }
        std::ofstream(file, std::ios::binary) << text;
        try {
            for (const BoothColours& one : read_booth_colours(file))
                CHECK(one.colours.size() <= 60);
        } catch (const RunError& error) {
            ++named;
            CHECK_THAT(error.what(), Catch::Contains("line "));
        }
    }
    CHECK(named > 50);
    std::filesystem::remove(file);
    CHECK_THROWS_WITH(read_booth_colours(file), Catch::Contains("puckloop-tams.csv"));
}
