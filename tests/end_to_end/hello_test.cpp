// scenarios/hello.toml: what a run leaves behind, and that it is the same in every placement and under load.

#include "tests/end_to_end/kit/load.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>

using namespace puckloop::tests;
using Catch::Contains;

namespace {
const std::string kHello = PUCKLOOP_SOURCE "/scenarios/hello.toml";
constexpr const char* kNodes[] = {"world", "robot0.pic", "robot0.i2c", "robot0.linux"};
}  // namespace

TEST_CASE("hello.toml drives the robot, keeps it off the walls and reports the run") {
    const Workbench bench;
    const Ended ended = bench.run("o", {kHello, "--duration", "20", "--in-process"});
    REQUIRE(ended.status == 0);
    CHECK(ended.err.empty());
    CHECK_THAT(ended.out, Contains("20.02"));

    const auto report = bench.report("o");
    CHECK(report["success"] == true);
    // The program is asked to end at 20 s.
    CHECK(report["simulated_s"].get<double>() == Approx(20.02).margin(0.01));
    CHECK(report["wall_s"] > 0.0);
    CHECK(report["real_time_factor"] > 0.0);
    CHECK(report["trace_sha256"].get<std::string>().size() == 64);
    CHECK(report["warnings"].empty());
    CHECK(report["unmodelled_registers"].is_array());
    for (const char* node : kNodes)
        CHECK(report["nodes"].contains(node));
    const auto& uart = report["links"]["robot0.uart"];
    CHECK(uart["from_a"]["uart_frames"] > 1000);
    CHECK(uart["from_b"]["uart_frames"] > 10'000);
    CHECK(report["nodes"]["robot0.pic"]["uart2"]["framing_errors"] == 0);

    const Journey path = journey(bench.csv("o", "trajectory.csv"));
    CHECK(path.last_s == Approx(20.0).margin(0.11));
    CHECK(path.length > 0.5);
    CHECK(path.clearance > 0.0);
    CHECK(bench.csv("o", "sensors.csv").size() >= 200);
    CHECK_THAT(text_of(bench.out("o") / "robot0.linux.log"), Contains("session started"));
    CHECK_THAT(text_of(bench.out("o") / "trajectory.svg"), Contains("<svg") && Contains("</svg>"));
}

TEST_CASE("the picture of a run is well-formed XML") {
    if (std::system("command -v xmllint >/dev/null 2>&1 || command -v python3 >/dev/null 2>&1") != 0) {
        WARN("neither xmllint nor python3 is here: the picture is not parsed");
        return;
    }
    const Workbench bench;
    REQUIRE(bench.run("o", {kHello, "--duration", "2", "--in-process"}).status == 0);
    const std::string file = bench.out("o") / "trajectory.svg";
    const std::string command = "xmllint --noout " + file +
                                " 2>/dev/null || python3 -c 'import sys, xml.dom.minidom; "
                                "xml.dom.minidom.parse(sys.argv[1])' " +
                                file;
    CHECK(std::system(command.c_str()) == 0);
}

TEST_CASE("hello.toml leaves the same bytes in one process and in many, again and again") {
    const Workbench bench;
    for (const char* name : {"one", "one again"})
        REQUIRE(bench.run(name, {kHello, "--duration", "6", "--in-process"}).status == 0);
    for (const char* name : {"many", "many again", "many a third time"})
        REQUIRE(bench.run(name, {kHello, "--duration", "6"}).status == 0);
    for (const char* name : {"one again", "many", "many again", "many a third time"})
        check_same_run(bench, "one", name);
}

TEST_CASE("hello.toml leaves the same bytes on a busy machine") {
    const Workbench bench;
    REQUIRE(bench.run("idle", {kHello, "--duration", "4", "--in-process"}).status == 0);
    const Load load(3);
    REQUIRE(bench.run("busy", {kHello, "--duration", "4"}).status == 0);
    REQUIRE(bench.run("busy in one", {kHello, "--duration", "4", "--in-process"}).status == 0);
    check_same_run(bench, "idle", "busy");
    check_same_run(bench, "idle", "busy in one");
}

TEST_CASE("another seed gives another run") {
    const Workbench bench;
    for (const char* seed : {"1", "2"})
        REQUIRE(bench.run(seed, {kHello, "--duration", "2", "--in-process", "--seed", seed}).status == 0);
    CHECK(bench.report("1")["trace_sha256"] != bench.report("2")["trace_sha256"]);
    CHECK(bench.report("2")["seed"] == 2);
}

TEST_CASE("the option --json prints only where the report is") {
    const Workbench bench;
    const Ended ended = bench.run("o", {kHello, "--duration", "1", "--in-process", "--json"});
    CHECK(ended.status == 0);
    CHECK(ended.out == (bench.out("o") / "report.json").string() + "\n");
}
