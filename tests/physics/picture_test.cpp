// The picture of a run, drawn from its recordings.

#include "base/error.h"
#include "physics/render/path_file.h"
#include "physics/render/trajectory_svg.h"
#include "physics/world/booth_record.h"
#include "physics/world/recorder.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/physics/worlds.h"

#include <catch2/catch.hpp>

#include <filesystem>
#include <fstream>

using namespace puckloop;
using namespace puckloop::physics;
using namespace puckloop::physics::test;

namespace {

World furnished() {
    World world;
    world.arena = rectangular_arena(1.2, 0.9);
    world.robots = {robot_at("e1", -0.1, 0, 0.5), robot_at("<e2>", 0.3, -0.3, 2.0)};
    Box carton{.name = "carton", .x = 0.3, .y = 0.15, .heading = 0.35, .length = 0.15};
    world.boxes.push_back(carton);
    Box crate{.name = "crate", .x = 0.15, .y = -0.18, .length = 0.06, .width = 0.06, .movable = true};
    world.boxes.push_back(crate);
    world.cylinders.push_back({.name = "can", .x = -0.25, .y = -0.2});
    world.walls.push_back({.name = "screen", .from = {-0.5, 0.2}, .to = {-0.3, 0.3}});
    world.booths.push_back({.name = "shop", .x = 0.45, .y = -0.3, .heading = 3.1});
    world.lamps.push_back({.name = "lamp", .x = -0.45, .y = 0.35});
    world.patches.push_back(
        {.name = "spot", .shape = Patch::Shape::Disc, .x = 0.15, .y = -0.35, .radius = 0.1, .grey = 0.1});
    world.patches.push_back(
        {.name = "line", .x = -0.1, .y = 0.1, .heading = 0.6, .length = 0.5, .width = 0.03, .grey = 0.4});
    return world;
}

}  // namespace

TEST_CASE("a picture shows arena, things, paths and robots, even of a run that died") {
    const auto directory = puckloop::tests::scratch_path("puckloop-physics-picture-test");
    std::filesystem::create_directories(directory);
    World world = furnished();
    world.recording.directory = directory.string();
    {
        WorldModel model(world);
        Recorder recorder(model);
        BoothRecord booths((directory / "tams.csv").string(), model);
        Driver first(model, 0), second(model, 1);
        for (int i = 0; i < 24000; ++i) {  // wanders in arcs and turns when it comes near something
            const auto& c = model.robot(0).channels();
            const bool near = c[0] > 200 || c[1] > 200 || c[6] > 200 || c[7] > 200;
            first.feed(near ? -400 : 480, near ? 400 : 520);
            second.feed(i < 6000 ? 420 : 0, i < 6000 ? 420 : 0);
            if (i == 9000) model.booth(0).shine(3, 1, 0.1);
            model.step();
            recorder.after_step(model);
            booths.after_step(model);
        }
    }
    std::ofstream(directory / "trajectory.csv", std::ios::app) << "24.100,e1,0.1";  // cut off
    write_trajectory_svg(world, directory);
    const auto svg = tests::text_of(directory / "trajectory.svg");
    CHECK(svg.rfind("<svg ", 0) == 0);
    CHECK(svg.find("nan") == std::string::npos);
    for (const char* word : {"carton", "crate", "can", "lamp", "&lt;e2&gt;", "20 s", "metres",
                             "24 s of simulated", "shop", "#00eb00"})
        CHECK(svg.find(word) != std::string::npos);
    const auto colours = read_booth_colours(directory / "tams.csv");
    REQUIRE(colours.size() == 1);
    CHECK(colours[0].name == "shop");
    REQUIRE(colours[0].colours.size() == 2);
    CHECK(colours[0].colours[1].seconds == Approx(9.001));
    CHECK(colours[0].colours[1].green == Approx(0.1));
    const auto paths = read_paths(directory / "trajectory.csv");
    REQUIRE(paths.size() == 2);
    CHECK(paths[0].second.size() == 241);
    if (std::getenv("PUCKLOOP_KEEP_PICTURE") == nullptr) std::filesystem::remove_all(directory);
}

TEST_CASE("a damaged or missing recording is named") {
    const auto directory = puckloop::tests::scratch_path("puckloop-physics-damaged-test");
    std::filesystem::create_directories(directory);
    CHECK_THROWS_WITH(write_trajectory_svg(furnished(), directory), Catch::Contains("trajectory.csv"));
    std::ofstream(directory / "trajectory.csv") << "t_s,robot,x_m,y_m,theta_rad\n0,e1,zero,0,0\n0,e1,0,0,0\n";
    CHECK_THROWS_WITH(write_trajectory_svg(furnished(), directory), Catch::Contains("line 2"));
    std::filesystem::remove_all(directory);
}
