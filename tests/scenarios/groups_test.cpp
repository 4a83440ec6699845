// [[group]] tables: places, spreads, names.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <numeric>
#include <set>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kRoom = "[run]\nduration = \"5 s\"\nseed = 7\n[arena]\nsize = [\"2 m\", \"2 m\"]\n";
const std::string kPic = "[group.pic]\nfirmware = \"own\"\n";

Scenario scenario_of(const std::string& text, const Settings& settings = {}) {
    const TemporaryFile file(text);
    return read_scenario(file.path(), settings);
}

std::string problem_of(const std::string& text) {
    try {
        scenario_of(text);
    } catch (const InputError& error) {
        const std::string what = error.what();
        return what.substr(std::min(what.find("line "), what.size()));
    }
    return "accepted";
}

std::vector<double> places_of(const Scenario& scenario) {
    std::vector<double> places;
    for (const auto& robot : scenario.world.robots)
        for (const double value : {robot.x, robot.y, robot.heading})
            places.push_back(value);
    return places;
}

}  // namespace

TEST_CASE("a group of twenty in a disc: names, places inside, none overlapping, drawn by the seed") {
    const std::string text =
        kRoom + "[[group]]\nname = \"epuck{n}\"\ncount = 20\nfirst = 1\n" + kPic +
        "[group.place]\nkind = \"disc\"\ncentre = [\"10 cm\", \"0 m\"]\nradius = \"40 cm\"\ngap = \"1 cm\"\n";
    const Scenario scenario = scenario_of(text);
    REQUIRE(scenario.robots.size() == 20);
    CHECK(scenario.robots.front().name == "epuck1");
    CHECK(scenario.robots.back().name == "epuck20");
    const auto& robots = scenario.world.robots;
    for (std::size_t i = 0; i < robots.size(); ++i) {
        CHECK(std::hypot(robots[i].x - 0.1, robots[i].y) <= 0.4 + 1e-4);
        for (std::size_t j = 0; j < i; ++j)
            CHECK(std::hypot(robots[i].x - robots[j].x, robots[i].y - robots[j].y) > 0.07 + 0.01 - 1e-6);
    }
    CHECK(places_of(scenario_of(text)) == places_of(scenario));
    Settings other;
    other.seed = 8;
    const Scenario again = scenario_of(text, other);
    CHECK(again.seed == 8);
    CHECK(places_of(again) != places_of(scenario));
}

TEST_CASE("places in a disc are uniform over its area") {
    // 600 robots of 1 mm: half of them within 1/sqrt(2) of the radius; four standard deviations are 49.
    const Scenario scenario = scenario_of(
        kRoom + "[[group]]\ncount = 600\n" + kPic +
        "[group.parameters]\nrobot.radius = \"2 cm\"\n[group.place]\nkind = \"disc\"\nradius = \"98 cm\"\n");
    const auto inner =
        std::count_if(scenario.world.robots.begin(), scenario.world.robots.end(),
                      [](const auto& robot) { return std::hypot(robot.x, robot.y) < 0.98 / std::sqrt(2.0); });
    CHECK(std::abs(static_cast<double>(inner) - 300.0) < 49.0);
}

TEST_CASE("a ring, a grid and a list put units where they say") {
    const Scenario ring =
        scenario_of(kRoom + "[[group]]\ncount = 4\n" + kPic +
                    "[group.place]\nkind = \"ring\"\nradius = \"50 cm\"\nheading = \"in\"\n");
    CHECK(ring.world.robots[1].y == Approx(0.5));
    CHECK(std::cos(ring.world.robots[1].heading) == Approx(0.0).margin(1e-9));
    CHECK(std::sin(ring.world.robots[1].heading) == Approx(-1.0));

    // As ARGoS fills a grid: from the largest x and y down, x first.
    const Scenario grid = scenario_of(kRoom + "[[group]]\ncount = 5\n" + kPic +
                                      "[group.place]\nkind = \"grid\"\ncolumns = 3\nrows = 2\n"
                                      "distance = [\"20 cm\", \"30 cm\"]\nheading = \"90 deg\"\n");
    CHECK(grid.world.robots[0].x == Approx(0.2));
    CHECK(grid.world.robots[0].y == Approx(0.15));
    CHECK(grid.world.robots[2].x == Approx(-0.2));
    CHECK(grid.world.robots[3].y == Approx(-0.15));
    CHECK(std::sin(grid.world.robots[4].heading) == Approx(1.0));

    const Scenario list = scenario_of(
        kRoom + "[[group]]\nnames = [\"anna\", \"otto\"]\n" + kPic +
        "[group.place]\nkind = \"list\"\npositions = [[\"1 cm\", \"2 cm\"], [\"30 cm\", \"0 m\"]]\n"
        "headings = [\"0 deg\", \"180 deg\"]\n");
    REQUIRE(list.robots.size() == 2);
    CHECK(list.robots[1].name == "otto");
    CHECK(list.world.robots[1].x == Approx(0.3));
}

TEST_CASE("values are spread over the units, each key by a stream of its own") {
    const std::string head = kRoom + "[[group]]\ncount = 400\n";
    const std::string place = "[group.parameters]\nrobot.radius = \"2 cm\"\n";
    const std::string pic = "[group.pic]\nfirmware = \"own\"\ncrystal_error = \"normal(0, 15 ppm)\"\n";
    const std::string program =
        "[group.linux]\nprogram = \"x\"\nstart = \"uniform(1 s, 3 s)\"\nhostname = \"puck{n}\"\n";
    const Scenario scenario = scenario_of(head + place + pic + program);
    double sum = 0.0, squares = 0.0, earliest = 9.0, latest = 0.0;
    for (const auto& robot : scenario.robots) {
        sum += robot.pic.crystal_ppm;
        squares += robot.pic.crystal_ppm * robot.pic.crystal_ppm;
        earliest = std::min(earliest, robot.linux_board->start);
        latest = std::max(latest, robot.linux_board->start);
    }
    CHECK(std::abs(sum / 400) < 4 * 15.0 / 20.0);                       // four standard errors
    CHECK(std::sqrt(squares / 400) == Approx(15.0).epsilon(4 / 28.2));  // of a deviation: 1/sqrt(2 n)
    CHECK(earliest >= 1.0);
    CHECK(earliest < 1.1);
    CHECK(latest > 2.9);
    CHECK(latest <= 3.0);
    CHECK(scenario.robots[12].linux_board->hostname == "puck12");
    // Without the program, crystals and places are the same.
    const Scenario fewer = scenario_of(head + place + pic);
    CHECK(fewer.robots[17].pic.crystal_ppm == scenario.robots[17].pic.crystal_ppm);
    CHECK(places_of(fewer) == places_of(scenario));
}

TEST_CASE("groups of boxes and cylinders keep clear of robots and of each other") {
    const Scenario scenario =
        scenario_of(kRoom + "[[robot]]\nposition = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"own\"\n" +
                    "[[group]]\nof = \"box\"\ncount = 12\nsize = [\"20 cm\", \"20 cm\", \"10 cm\"]\n"
                    "[[group]]\nof = \"cylinder\"\ncount = 8\nradius = \"5 cm\"\nmass = \"100 g\"\n"
                    "[[group]]\nof = \"lamp\"\ncount = 2\nintensity = 0.5\n");
    CHECK(scenario.world.boxes.size() == 12);
    CHECK(scenario.world.cylinders.size() == 8);
    CHECK(scenario.world.cylinders[7].name == "cylinder7");
    CHECK(scenario.world.lamps.size() == 2);  // that nothing overlaps is what read_scenario checks last
}

TEST_CASE("what a group cannot be is one line with its place") {
    CHECK(problem_of(kRoom + "[[group]]\n" + kPic) ==
          "line 6: group: 'count' is missing (expected count = 20)");
    CHECK(problem_of(kRoom + "[[group]]\ncount = 900\n" + kPic +
                     "[group.place]\nkind = \"disc\"\nradius = \"9 cm\"\n")
              .starts_with("line 10: robot"));
    CHECK(problem_of(
              kRoom + "[[group]]\ncount = 2\n" + kPic +
              "[group.place]\nkind = \"list\"\npositions = [[\"0 m\", \"0 m\"], [\"1 cm\", \"0 m\"]]\n") ==
          "line 10: robot1, unit 2 of 2, has no free place: robot0 is there (expected places that are free)");
    CHECK(problem_of(kRoom + "[[group]]\ncount = 2\nposition = [\"0 m\", \"0 m\"]\n" + kPic) ==
          "line 8: group: the units of a group have no common position (expected [group.place])");
    CHECK(problem_of(kRoom + "[[group]]\ncount = 2\n[group.pic]\nfirmware = \"own\"\ncrystal_error = "
                             "\"normal(1 ppm, 2 %)\"\n") ==
          "line 10: pic.crystal_error: 'normal(1 ppm, 2 %)' has two units (expected both values in the same "
          "unit)");
    CHECK(problem_of(kRoom + "[[group]]\ncount = 2\n[group.pic]\nfirmware = \"onw\"\n")
              .starts_with("line 9: robot0.pic: there is no shipped image 'onw' for this board (expected one "
                           "of \"own\""));
    CHECK(problem_of(kRoom + "[[group]]\ncount = 2\ncolour = 3\n" + kPic)
              .starts_with("line 8: robot0: unknown key 'colour'"));
    CHECK(problem_of(kRoom + "[[group]]\ncount = 2\n" + kPic +
                     "[group.place]\nkind = \"disc\"\nradius = \"1 cm\"\nheading = \"normal(0, 1 cm)\"\n")
              .starts_with("line 13: group robot{n}.place: heading"));
}
