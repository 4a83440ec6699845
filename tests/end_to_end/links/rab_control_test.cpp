// puckloop-control and its range-and-bearing driver on whole robots: Linux program, I2C bus, board with the
// project's own firmware, infra-red medium.

#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <regex>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

struct Robot {
    std::string position;
    std::string heading;
    std::string options;  ///< of puckloop-control, as TOML strings
    bool board = true;
};

std::string scenario(const std::string& duration, const std::vector<Robot>& robots) {
    const std::string firmware = PUCKLOOP_SOURCE "/firmware/";
    std::string text = "[run]\nduration = \"" + duration + "\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n";
    for (std::size_t i = 0; i < robots.size(); ++i) {
        text += "[[robot]]\nname = \"robot" + std::to_string(i) + "\"\nposition = [" + robots[i].position +
                "]\nheading = \"" + robots[i].heading + "\"\n[robot.pic]\nfirmware = \"" + firmware +
                "epuck/epuck.hex\"\n";
        if (robots[i].board) text += "[robot.rab]\nfirmware = \"" + firmware + "rab/rab.hex\"\n";
        text += "[robot.linux]\nprogram = [\"puckloop-control\", " + robots[i].options +
                "]\nstart = \"100 ms\"\n";
    }
    return text;
}

/// Messages a second from `id` as the program's log has them, second by second.
std::vector<int> heard(const std::string& log, int id) {
    std::vector<int> counts;
    const std::regex line("messages a second:[^\n]*[ ,]" + std::to_string(id) + ": ([0-9]+)");
    for (std::sregex_iterator match(log.begin(), log.end(), line), end; match != end; ++match)
        counts.push_back(std::stoi((*match)[1]));
    return counts;
}

}  // namespace

TEST_CASE("two robots hear each other's packets and aggregate") {
    const Workbench bench;
    const auto file = bench.file(
        "two.toml",
        scenario("4.5 s", {{R"("-20 cm", "0 cm")", "60 deg",
                            R"("--behaviour", "aggregate", "--rab-id", "1", "--duration", "4")"},
                           {R"("20 cm", "0 cm")", "90 deg",
                            R"("--behaviour", "aggregate", "--rab-id", "2", "--duration", "4")"}}));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    for (int robot = 0; robot < 2; ++robot) {
        const std::string log = text_of(bench.out("o") / ("robot" + std::to_string(robot) + ".linux.log"));
        const std::vector<int> counts = heard(log, robot == 0 ? 2 : 1);
        INFO(log);
        REQUIRE(counts.size() >= 3);
        for (const int count : counts)
            CHECK(count >= 40);  // 50 are sent
        CHECK_THAT(log, Contains("failed 0, board set up 1"));
    }
    double x[2] = {}, y[2] = {};
    for (const Row& row : bench.csv("o", "trajectory.csv")) {
        const int robot = row.at("robot") == "robot0" ? 0 : 1;
        x[robot] = std::stod(row.at("x_m"));
        y[robot] = std::stod(row.at("y_m"));
    }
    const double apart = std::hypot(x[0] - x[1], y[0] - y[1]);
    CHECK(apart < 0.36);  // from 0.40
    CHECK(apart > 0.07);
}

TEST_CASE("a robot without a range-and-bearing board goes on, or ends with status 2 if it must have one") {
    for (const bool required : {false, true}) {
        const Workbench bench;
        const std::string options =
            std::string(R"("--behaviour", "wander", "--rab-id", "1", "--duration", "1", )") +
            (required ? R"("--rab-required")" : R"("--rab")");
        const auto file =
            bench.file("one.toml", scenario("2 s", {{R"("0 cm", "0 cm")", "0 deg", options, false}}));
        bench.run("o", {file, "--in-process"});
        const std::string log = text_of(bench.out("o") / "robot0.linux.log");
        INFO(log);
        CHECK_THAT(log, Contains("0x20 does not answer: Remote I/O error"));
        CHECK((log.find("records received 1") != std::string::npos) == !required);
        CHECK(bench.report("o")["nodes"]["robot0.linux"]["end"] ==
              (required ? "exited with status 2" : "exited with status 0"));
    }
}

TEST_CASE("calibration with a robot that sends 20 cm away prints the gain") {
    const Workbench bench;
    const auto file = bench.file(
        "calibration.toml",
        scenario("4 s", {{R"("0 cm", "0 cm")", "0 deg", R"("--rab-calibrate", "100", "--rab-id", "1")"},
                         {R"("27 cm", "0 cm")", "90 deg",
                          R"("--behaviour", "still", "--rab", "--rab-id", "2", "--duration", "3.5")"}}));
    const Ended ended = bench.run("o", {file, "--in-process"});
    INFO(ended.err);
    const std::string log = text_of(bench.out("o") / "robot0.linux.log");
    INFO(log);
    std::smatch match;
    REQUIRE(std::regex_search(log, match,
                              std::regex("100 messages, strength ([0-9.]+), .*\n--rab-gain ([0-9.]+)")));
    const double strength = std::stod(match[1]);
    CHECK(strength == Approx(1074).epsilon(0.35));  // parts differ
    CHECK(std::stod(match[2]) ==
          Approx(20 / std::exp(9.06422181283387 - 0.00565074879677167 * strength)).epsilon(0.001));
}
