// Things that only robots sense, in whole runs: firmware and programs feel them, and nothing else does.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// A robot that wanders to the right, towards what `tables` put in its way.
std::string wanderer(const std::string& tables) {
    return R"([run]
duration = "6 s"
[arena]
size = ["2 m", "1 m"]
[[robot]]
name = "one"
position = ["-20 cm", "0 cm"]
[robot.pic]
firmware = "own"
[robot.linux]
program = ["puckloop-control", "--behaviour", "wander", "--duration", "60"]
start = "50 ms"
)" + tables;
}

constexpr const char* kBorder = R"([[virtual_wall]]
name = "border"
from = ["0 cm", "-50 cm"]
to = ["0 cm", "50 cm"]
thickness = "4 cm"
)";

double farthest(const std::vector<Row>& rows) {
    double most = -9;
    for (const Row& row : rows)
        most = std::max(most, std::stod(row.at("x_m")));
    return most;
}

double number(const Row& row, const char* column) {
    return std::stod(row.at(column));
}

}  // namespace

TEST_CASE("a robot turns away from a virtual wall that a named other one does not feel") {
    const Workbench bench;
    const auto run = [&](const std::string& name, const std::string& tables) {
        REQUIRE(bench.run(name, {bench.file(name + ".toml", wanderer(tables)), "--in-process"}).status == 0);
        return farthest(bench.csv(name, "trajectory.csv"));
    };
    CHECK(run("free", "") > 0.2);
    CHECK(run("stopped", kBorder) < -0.02);
    const std::string other = R"([[robot]]
name = "other"
position = ["-20 cm", "40 cm"]
[robot.pic]
firmware = "own"
)";
    CHECK(run("of_other", other + kBorder + "robots = [\"other\"]\n") > 0.2);
}

TEST_CASE("the shipped virtual scenario is the same run in one process and in several") {
    const Workbench bench;
    const std::string scenario = PUCKLOOP_SOURCE "/scenarios/virtual.toml";
    REQUIRE(bench.run("one", {scenario, "--in-process", "--duration", "8"}).status == 0);
    REQUIRE(bench.run("several", {scenario, "--duration", "8"}).status == 0);
    check_same_run(bench, "one", "several");
    // The leader's trail lies where it was, and nowhere else.
    const auto trail = bench.csv("one", "pheromones.csv");
    REQUIRE(trail.size() > 50);
    std::vector<Row> way;
    for (const Row& row : bench.csv("one", "trajectory.csv"))
        if (row.at("robot") == "leader") way.push_back(row);
    for (const Row& square : trail) {
        double nearest = 9;
        for (const Row& row : way)
            nearest = std::min(nearest, std::hypot(number(row, "x_m") - number(square, "x_m"),
                                                   number(row, "y_m") - number(square, "y_m")));
        CHECK(nearest < 0.04 + 0.03);  // its radius, and what has spread since
        CHECK(number(square, "strength") <= 1.0);
    }
    for (const Row& row : bench.csv("one", "trajectory.csv"))
        CHECK(number(row, "y_m") > -0.1);  // behind the border
}

TEST_CASE("a program hears, with its bytes, a board that is not there") {
    const Workbench bench;
    const std::string text = wanderer(R"([robot.rab]
firmware = "own"
[[virtual_board]]
name = "caller"
position = ["10 cm", "10 cm"]
data = [200, 1]
)");
    std::string follow = text;
    const std::string wander = "\"--behaviour\", \"wander\"";
    follow.replace(follow.find(wander), wander.size(),
                   R"("--behaviour", "follow", "--rab-id", "1", "--rab-bytes", "2")");
    REQUIRE(bench.run("called", {bench.file("called.toml", follow), "--in-process"}).status == 0);
    const auto frames = bench.csv("called", "ir.csv");
    const auto of_caller = std::count_if(frames.begin(), frames.end(), [](const Row& row) {
        return row.at("sender") == "caller" && row.at("receiver") == "one" && row.at("heard") == "1";
    });
    CHECK(of_caller > 40);
    // Its bytes came through the firmware to the program: that is what "delivered" says.
    const auto table = bench.puckloop({"trace", "rab", bench.out("called").string(), "--json"});
    REQUIRE(table.status == 0);
    const auto group = nlohmann::json::parse(table.out).at("groups").at(1);
    CHECK(group.at("group") == "caller -> one");
    CHECK(group.at("delivered").get<double>() > 0.9 * static_cast<double>(of_caller));
}

TEST_CASE("what is wrong with a virtual thing is one line with its place") {
    const Workbench bench;
    const auto refused = [&](const std::string& table, const Words& words) {
        check_one_line(bench.run("bad", {bench.file("bad.toml", wanderer(table)), "--in-process"}), 2, words);
    };
    refused(std::string(kBorder) + "robots = [\"nobody\"]\n", {"line 13", "there is no robot 'nobody'"});
    refused("[[virtual_box]]\ncentre = [\"0 m\", \"0 m\"]\nsize = [\"1 cm\", \"1 cm\", \"1 cm\"]\n"
            "mass = \"1 kg\"\n",
            {"line 16", "a virtual box has none"});
    refused("[[pheromone]]\nhalf_live = \"3 s\"\n", {"line 14", "half_life"});
    refused("[[pheromone]]\nled = \"led9\"\n", {"led9"});
    refused("[[virtual_board]]\nposition = [\"0 m\", \"0 m\"]\ndata = [1]\n",
            {"no robot has a range-and-bearing board"});
    refused("[[virtual_board]]\nposition = [\"0 m\", \"0 m\"]\ndata = [1, 256]\n", {"256 is not a byte"});
}
