// [mission] tables, and the score of a recorded run.

#include "base/error.h"
#include "base/files/text_file.h"
#include "base/json.h"
#include "run/report/mission_score.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::scenarios;

namespace {

const std::string kRest = "[arena]\nsize = [\"2 m\", \"2 m\"]\n[[robot]]\nposition = [\"0 m\", \"0 "
                          "m\"]\n[robot.pic]\nfirmware = \"own\"\n";

Scenario scenario_of(const std::string& text) {
    const TemporaryFile file(text + kRest);
    return read_scenario(file.path());
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

}  // namespace

TEST_CASE("a mission is a small table") {
    const Scenario scenario =
        scenario_of("[mission]\nkind = \"foraging\"\nbegin = \"2 s\"\n[[mission.spot]]\nshape = "
                    "\"disc\"\ncentre = [\"75 cm\", \"0 m\"]\n"
                    "radius = \"25 cm\"\n[[mission.spot]]\nshape = \"disc\"\ncentre = [\"-75 cm\", \"0 "
                    "m\"]\nradius = \"25 cm\"\n"
                    "[mission.nest]\ncentre = [\"0 m\", \"-1 m\"]\nsize = [\"3 m\", \"80 cm\"]\n");
    REQUIRE(scenario.mission);
    CHECK(scenario.mission->kind == missions::Kind::Foraging);
    CHECK(scenario.mission->spots.size() == 2);
    CHECK(scenario.mission->begin == Approx(2.0));
    CHECK(scenario.mission->nest.width == Approx(0.8));
    CHECK_FALSE(scenario_of("").mission);
}

TEST_CASE("a mission that lacks what it counts is one line") {
    CHECK(problem_of("[mission]\nkind = \"dance\"\n")
              .starts_with("line 2: mission: kind: 'dance' is not known"));
    CHECK(
        problem_of("[mission]\nkind = \"aggregation\"\n").starts_with("line 1: mission: 'spot' is missing"));
    CHECK(problem_of("[mission]\nkind = \"foraging\"\n[[mission.spot]]\nsize = [\"1 m\", \"1 m\"]\n")
              .find("'nest' is missing") != std::string::npos);
    CHECK(
        problem_of(
            "[mission]\nkind = \"coverage\"\nstep = \"150 ms\"\n[mission.area]\nsize = [\"1 m\", \"1 m\"]\n")
            .starts_with("line 3: mission: step is no multiple of 0.1 s"));
    CHECK(
        problem_of("[mission]\nkind = \"coverage\"\nbegin = \"50 ms\"\n[mission.area]\nsize = [\"1 m\", \"1 "
                   "m\"]\n")
            .starts_with("line 3: mission: begin is no multiple of 0.1 s"));
    CHECK(problem_of("[mission]\nkind = \"coverage\"\nstep = \"0 s\"\n")
              .starts_with("line 3: mission: step is out"));
    CHECK(problem_of("[mission]\nkind = \"coverage\"\ncells = 3\n")
              .starts_with("line 3: mission: coverage has no cells"));
    CHECK(problem_of("[mission]\nkind = \"shelter\"\n[[mission.spot]]\nradius = \"1 m\"\n")
              .starts_with("line 4: mission.spot: a rectangle has no radius"));
    CHECK(problem_of(
              "[mission]\nkind = \"grid_exploration\"\n[mission.area]\nshape = \"disc\"\nradius = \"1 m\"\n")
              .starts_with("line 3: mission: a grid of cells is a rectangle"));
    CHECK(problem_of("[mission]\nkind = \"coverage\"\n[mission.area]\nsize = [\"1 m\", \"0 m\"]\n")
              .starts_with("line 4: mission.area: size is out of range"));
}

TEST_CASE("a mission of another file counts in place of the scenario's") {
    const TemporaryFile mission(
        "[mission]\nkind = \"shelter\"\n[[mission.spot]]\nsize = [\"1 m\", \"2 m\"]\n");
    const TemporaryFile scenario(
        "[mission]\nkind = \"coverage\"\n[mission.area]\nsize = [\"1 m\", \"1 m\"]\n" + kRest);
    Settings settings;
    settings.mission = mission.path();
    const Scenario read = read_scenario(scenario.path(), settings);
    REQUIRE(read.mission);
    CHECK(read.mission->name == "shelter");
    CHECK(read.mission->spots.at(0).width == Approx(2.0));
    const TemporaryFile without(kRest);
    settings.mission = without.path();
    CHECK_THROWS_WITH(read_scenario(scenario.path(), settings), Catch::Contains("there is no [mission]"));
}

TEST_CASE("a run is scored by its trajectory, from the mission's beginning, step by step") {
    const TemporaryFile file("t_s,robot,x_m,y_m,theta_rad\n"
                             "0.000,a,0,0,0\n0.000,b,0,0,0\n"    // time 0 ends no step
                             "0.050,a,0,0,0\n0.050,b,0,0,0\n"    // between steps
                             "0.100,a,0,0,0\n0.100,b,1,0,0\n"    // one
                             "0.200,a,0,0,0\n0.200,b,0.1,0,0\n"  // two
                             "0.300,a,1,0,0\n");                 // b's row is lost
    missions::Mission mission;
    mission.name = "aggregation";
    mission.spots = {missions::Region{true, 0.0, 0.0, 0.2, 0.0, 0.0}};
    const auto score = tools::mission_score(mission, file.path());
    CHECK(score.at("score") == 3.0);
    CHECK(score.at("steps") == 2);
    CHECK(score.at("better") == "more");
    CHECK(tools::mission_summary(tools::mission_score(mission, file.path())) ==
          "mission aggregation: score 3 (more is better), 2 steps of 0.1 s");
    mission.begin = 0.1;
    CHECK(tools::mission_score(mission, file.path()).at("score") == 2.0);
    CHECK(tools::mission_score(mission, "/nowhere/trajectory.csv").at("score").is_null());
    mission.begin = 5.0;
    CHECK(tools::mission_score(mission, file.path()).at("score").is_null());
    CHECK(tools::mission_summary(tools::mission_score(mission, file.path())) ==
          "mission aggregation: no score: no step was counted");
}
