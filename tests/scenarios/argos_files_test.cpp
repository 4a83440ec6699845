// ARGoS experiment files as scenarios.

#include "base/error.h"
#include "scenarios/argos/import.h"
#include "scenarios/argos/toml_tree.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <filesystem>
#include <numbers>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kFolder = std::string(PUCKLOOP_SCENARIOS) + "/../tests/scenarios/argos/";

class ArgosFile {
  public:
    explicit ArgosFile(const std::string& text)
        : path_(std::filesystem::temp_directory_path() /
                ("puckloop_" + std::to_string(::getpid()) + ".argos")) {
        std::ofstream(path_) << text;
    }
    ~ArgosFile() { std::filesystem::remove(path_); }
    ArgosFile(const ArgosFile&) = delete;
    ArgosFile& operator=(const ArgosFile&) = delete;
    const std::filesystem::path& path() const { return path_; }

  private:
    std::filesystem::path path_;
};

/// An experiment with this in its arena and these devices of its controller.
std::string experiment(const std::string& arena, const std::string& sensors = "<epuck_proximity/>") {
    return "<argos-configuration>\n<framework><experiment length=\"5\"/></framework>\n<controllers><c "
           "id=\"a\"><sensors>\n" +
           sensors + "\n</sensors></c></controllers>\n<arena size=\"2,2,1\">\n" + arena +
           "\n</arena>\n</argos-configuration>\n";
}

std::string problem_of(const std::string& text) {
    const ArgosFile file(text);
    try {
        read_scenario(file.path());
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(std::min(what.find("line "), what.size()));
    }
    return "accepted";
}

const std::string kPuck =
    "<e-puck id=\"e\"><body position=\"0,0,0\" orientation=\"0,0,0\"/><controller config=\"a\"/></e-puck>";

}  // namespace

TEST_CASE(
    "a mission of the published form: room, boards that the controller needs, robots in the mission's disc") {
    const Scenario scenario = read_scenario(kFolder + "dodecagon.argos");
    CHECK(scenario.duration == Approx(30.0));
    CHECK(scenario.seed == 11);
    CHECK_FALSE(scenario.world.arena.walls);
    REQUIRE(scenario.world.boxes.size() == 2);
    CHECK(scenario.world.boxes[1].heading == Approx(std::numbers::pi / 6));
    CHECK(scenario.world.boxes[1].width == Approx(0.66));
    REQUIRE(scenario.world.lamps.size() == 1);
    CHECK(scenario.world.lamps[0].height == Approx(0.75));
    CHECK(scenario.world.lamps[0].intensity == Approx(5.0));
    REQUIRE(scenario.world.cylinders.size() == 1);
    CHECK(scenario.world.cylinders[0].mass == Approx(2.0));
    REQUIRE(scenario.robots.size() == 3);
    CHECK(scenario.robots[0].name == "epuck_01_30");
    for (const auto& robot : scenario.robots) {
        CHECK(robot.ground_sensor);
        CHECK(robot.rgb_turret);
        CHECK(robot.rab);
        REQUIRE(robot.linux_board);
        CHECK(robot.linux_board->command.empty());
        REQUIRE(robot.linux_board->arguments.size() == 4);
        CHECK(robot.linux_board->arguments[0] == "-c");
        CHECK(std::filesystem::equivalent(robot.linux_board->arguments[1], kFolder + "dodecagon.argos"));
        CHECK(robot.linux_board->arguments[3] == "fsm");
        REQUIRE(robot.linux_board->cameras.size() == 1);
        CHECK(robot.linux_board->cameras[0].kind == "omni");
    }
    for (const auto& robot : scenario.world.robots)
        CHECK(std::hypot(robot.x, robot.y) <= 1.0 + 1e-4);
}

TEST_CASE("what is not taken over is listed once, with its line") {
    const Scenario scenario = read_scenario(kFolder + "dodecagon.argos");
    const auto has = [&](const std::string& begin) {
        return std::count_if(scenario.not_taken.begin(), scenario.not_taken.end(),
                             [&](const std::string& note) { return note.starts_with(begin); });
    };
    for (const char* begin :
         {"line 7: the loop functions 'spots'", "line 8: the loop functions place the robots",
          "line 13: noise_std_dev of epuck_wheels", "line 18: noise_level of epuck_proximity",
          "line 19: loss_probability of epuck_range_and_bearing", "line 20: noise_level of epuck_ground",
          "line 28: the floor is painted", "line 37: <cylinder> 'post' is 0.1 m above the floor",
          "line 39: 'epuck_01.30' is called 'epuck_01_30'", "line 43: <physics_engines>",
          "line 44: <media>"}) {
        INFO(begin);
        CHECK(has(begin) == 1);
    }
    CHECK(scenario.not_taken.size() == 11);
    CHECK(std::is_sorted(scenario.not_taken.begin(), scenario.not_taken.end(),
                         [](const std::string& a, const std::string& b) {
                             return std::stoi(a.substr(5)) < std::stoi(b.substr(5));
                         }));
}

namespace {

/// `experiment()` whose loop functions have these parameters.
std::string with_loop_functions(const std::string& params, const std::string& arena) {
    std::string text = experiment(arena);
    return text.insert(text.find("<controllers>"), "<loop_functions library=\"l.so\" label=\"l\"><params " +
                                                       params + "/></loop_functions>\n");
}

const std::string kThreePucks =
    "<distribute><position method=\"uniform\" min=\"-0.9,-0.9,0\" max=\"0.9,0.9,0\"/><orientation "
    "method=\"gaussian\" mean=\"0,0,0\" std_dev=\"360,0,0\"/><entity quantity=\"3\" "
    "max_trials=\"100\"><e-puck "
    "id=\"epuck\"><controller config=\"a\"/></e-puck></entity></distribute>";

}  // namespace

TEST_CASE("loop functions that state a disc move the robots that the arena has, and make none beside them") {
    const ArgosFile file(with_loop_functions("dist_radius=\"0.3\" number_robots=\"3\"", kThreePucks));
    const Scenario scenario = read_scenario(file.path());
    REQUIRE(scenario.robots.size() == 3);
    CHECK(scenario.robots[0].name == "epuck0");
    CHECK(scenario.robots[2].name == "epuck2");
    for (const auto& robot : scenario.world.robots)
        CHECK(std::hypot(robot.x, robot.y) <= 0.3 + 1e-4);
    const ArgosFile none(with_loop_functions("dist_radius=\"0.3\" number_robots=\"2\"", ""));
    REQUIRE(read_scenario(none.path()).robots.size() == 2);
    CHECK(read_scenario(none.path()).robots[1].name == "epuck2");
}

TEST_CASE("walls that loop functions build are a regular polygon about the origin") {
    const ArgosFile file(with_loop_functions("number_robots=\"4\" build_arena=\"true\" number_edges=\"6\" "
                                             "number_boxes_per_edge=\"4\" lenght_boxes=\"0.25\"",
                                             ""));
    const Scenario scenario = read_scenario(file.path());
    REQUIRE(scenario.world.boxes.size() == 6);
    // Six triangles of 60 degrees with sides of 1 m: their height is half the square root of 3.
    const double to_wall = std::sqrt(3.0) / 2.0;
    for (std::size_t side = 0; side < 6; ++side) {
        const auto& wall = scenario.world.boxes[side];
        CHECK(std::hypot(wall.x, wall.y) == Approx(to_wall));
        CHECK(wall.width == Approx(1.0));
        CHECK(std::abs(std::remainder(std::atan2(wall.y, wall.x) - wall.heading, 2 * std::numbers::pi)) <
              1e-9);
    }
    REQUIRE(scenario.robots.size() == 4);
    for (const auto& robot : scenario.world.robots)
        CHECK(std::hypot(robot.x, robot.y) <= to_wall - 0.1 + 1e-4);
    // The other spelling, and a disc that the file states.
    const ArgosFile other(with_loop_functions("dist_radius=\"0.2\" build_arena=\"true\" number_edges=\"4\" "
                                              "number_boxes_per_edge=\"2\" length_boxes=\"0.5\"",
                                              kPuck));
    const Scenario square = read_scenario(other.path());
    REQUIRE(square.world.boxes.size() == 4);
    CHECK(square.world.boxes[1].y == Approx(0.5));
    CHECK(std::hypot(square.world.robots[0].x, square.world.robots[0].y) <= 0.2 + 1e-4);
}

TEST_CASE("what loop functions state out of range, or place by themselves, is refused with its line") {
    CHECK(problem_of(with_loop_functions("build_arena=\"true\" number_edges=\"2\"", kPuck)) ==
          "line 3: <params>: number_edges = '2' is out of range (expected a whole number from 3 to 100)");
    CHECK(problem_of(with_loop_functions("build_arena=\"true\" lenght_boxes=\"0\"", kPuck)) ==
          "line 3: <params>: lenght_boxes is not above 0 (expected a length in m)");
    CHECK(problem_of(with_loop_functions("nbEpucks=\"20\"", "<floor source=\"loop_functions\"/>")) ==
          "line 3: there are no robots: the loop functions place them, which are not executed (expected "
          "<e-puck> "
          "or <distribute> in <arena>, or <params number_robots=\"20\" dist_radius=\"1\"/>)");
}

TEST_CASE("distributions become groups drawn by the run's seed") {
    const Scenario scenario = read_scenario(kFolder + "distributions.argos");
    CHECK_FALSE(scenario.duration);
    CHECK(scenario.world.arena.corners[0].x == Approx(-1.0));
    REQUIRE(scenario.robots.size() == 14);
    CHECK(scenario.robots[0].name == "ep5");
    CHECK_FALSE(scenario.robots[0].ground_sensor);
    CHECK_FALSE(scenario.robots[0].rab);
    CHECK(scenario.robots[0].pic.firmware.filename() == "epuck.hex");
    CHECK(scenario.robots[13].pic.firmware.filename() == "epuck_ircom.hex");
    CHECK(scenario.world.ircom);
    CHECK(scenario.world.robots[12].x == Approx(2.1));
    CHECK(scenario.world.robots[13].x == Approx(1.9));
    CHECK(scenario.world.robots[13].heading == Approx(std::numbers::pi / 2));
    CHECK(scenario.world.boxes.size() == 4);
    CHECK(scenario.world.cylinders[0].x == Approx(-0.5));
    REQUIRE(scenario.tams.size() == 1);
    CHECK(scenario.tams[0].network == 2);
    Settings other;
    other.seed = 99;
    CHECK(read_scenario(kFolder + "distributions.argos", other).world.robots[0].x !=
          scenario.world.robots[0].x);
}

TEST_CASE("an imported file is the same scenario as the file itself") {
    for (const char* name : {"dodecagon.argos", "distributions.argos"}) {
        INFO(name);
        const argos::Imported imported = argos::import_experiment(kFolder + name, {});
        const TemporaryFile toml(argos::toml_text(imported.scenario));
        Scenario from_toml = read_scenario(toml.path());
        const Scenario direct = read_scenario(kFolder + name);
        // Lines and the file's name are those of the one file or the other.
        physics::World a = from_toml.world, b = direct.world;
        const auto anonymous = [](physics::World& world) {
            world.file.clear();
            const auto clear = [](auto& list) {
                for (auto& thing : list)
                    thing.place.clear();
            };
            world.arena.place.clear();
            clear(world.boxes);
            clear(world.cylinders);
            clear(world.lamps);
            clear(world.patches);
            clear(world.robots);
            clear(world.booths);
        };
        anonymous(a);
        anonymous(b);
        CHECK(physics::to_json(a) == physics::to_json(b));
        REQUIRE(from_toml.robots.size() == direct.robots.size());
        for (std::size_t i = 0; i < direct.robots.size(); ++i)
            CHECK(from_toml.robots[i].linux_board->arguments == direct.robots[i].linux_board->arguments);
    }
}

TEST_CASE("a bad experiment is one line with its place") {
    CHECK(problem_of("<argos-configuration>\n<framework>\n</arena>").starts_with("line 3: malformed XML"));
    CHECK(problem_of("\n<camera/>") ==
          "line 2: <camera> is no ARGoS experiment (expected <argos-configuration>)");
    CHECK(problem_of(experiment(kPuck)) == "accepted");
    CHECK(problem_of(experiment("<foot-bot id=\"f\"/>")) ==
          "line 7: <foot-bot> is no thing that can be here (expected e-puck, tams, box, cylinder, light, "
          "floor or distribute)");
    CHECK(problem_of(experiment(kPuck, "<positioning/>"))
              .starts_with(
                  "line 4: controller 'a' asks for sensor 'positioning', which the e-puck does not have"));
    CHECK(problem_of(
              experiment("<e-puck id=\"e\"><body position=\"0,0,0\"/><controller config=\"b\"/></e-puck>")) ==
          "line 7: there is no controller 'b' (expected one of a)");
    CHECK(problem_of(
              experiment("<box id=\"b\" size=\"1,2\" movable=\"false\"><body position=\"0,0,0\"/></box>")) ==
          "line 7: <box> 'b': size = '1,2' (expected 3 numbers of at most 1e6, separated by commas)");
    CHECK(problem_of(
              experiment("<e-puck id=\"e\"><body position=\"nan,0,0\"/><controller config=\"a\"/></e-puck>"))
              .starts_with("line 7: <body>: position"));
    CHECK(problem_of(experiment(kPuck + "\n" + kPuck))
              .starts_with("line 8: robot1: another robot is called 'e'"));
    CHECK(problem_of(
              experiment("<e-puck id=\"e\"><body position=\"3,0,0\"/><controller config=\"a\"/></e-puck>"))
              .starts_with("line 7: robot 'e': (3 m, 0 m) is outside the arena"));
    const auto distributed = [](const std::string& position, int quantity) {
        return experiment("<distribute>\n" + position +
                          "\n<orientation method=\"constant\" values=\"0,0,0\"/>\n<entity quantity=\"" +
                          std::to_string(quantity) +
                          "\" max_trials=\"50\"><e-puck id=\"e\"><controller "
                          "config=\"a\"/></e-puck></entity></distribute>");
    };
    CHECK(problem_of(distributed("<position method=\"uniform\" min=\"-.1,-.1,0\" max=\".1,.1,0\"/>", 40))
              .find("finds no free place in 50 trials") != std::string::npos);
    CHECK(problem_of(distributed("<position method=\"uniform\" min=\"5,5,0\" max=\"6,6,0\"/>", 1))
              .starts_with("line 8: e0, unit 1 of 1, finds no free place in 50 trials (of the last: it is "
                           "outside the arena)"));
    CHECK(problem_of(distributed("<position method=\"poisson\" mean=\"1,1,0\"/>", 1))
              .starts_with("line 8: there is no method 'poisson'"));
    CHECK(problem_of(
              distributed(
                  "<position method=\"grid\" center=\"0,0,0\" distances=\".2,.2,0\" layout=\"1,1,1\"/>", 2))
              .starts_with("line 10: 2 things in a grid of 1 x 1"));
}
