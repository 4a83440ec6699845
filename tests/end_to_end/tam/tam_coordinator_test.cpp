// The coordinator as a run's Linux program: TAMs are found over the air, robots work at them, LEDs go off at
// the end; the same in every placement. Real firmware in the TAMs where $PUCKLOOP_IMAGES has it.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

std::string firmware() {
    const auto real = outside("PUCKLOOP_IMAGES", "tam_firmware.elf");
    if (!real) WARN("without PUCKLOOP_IMAGES: the project's own firmware in place of the real one");
    return real ? real->string() : "own";
}

/// When an event of the table happened, from `after` on, s; -1: never.
double when(const std::vector<Row>& table, const std::string& tam, const std::string& event,
            const std::string& value, double after = 0) {
    for (const Row& row : table)
        if (row.at("tam") == tam && row.at("event") == event && row.at("value") == value &&
            std::stod(row.at("time_s")) >= after)
            return std::stod(row.at("time_s"));
    return -1;
}

std::string tams(const std::string& coordinator) {
    std::string text = "[run]\nduration = \"17 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n";
    for (const char* place : {"50 cm", "-50 cm"})
        text += fmt::format("[[tam]]\nposition = [\"{}\", \"0 m\"]\nfirmware = \"{}\"\n", place, firmware());
    return text + "[coordinator]\n" + coordinator;
}

}  // namespace

TEST_CASE("a coordinator's program finds its TAMs and sets their LEDs, the same in every placement") {
    const Workbench bench;
    const auto file =
        bench.file("tams.toml", tams("program = [\"puckloop-coordinator\", \"--seed\", \"3\"]\n"));
    REQUIRE(bench.run("one", {file, "--in-process", "--threads", "1"}).status == 0);
    REQUIRE(bench.run("threads", {file, "--in-process", "--threads", "4"}).status == 0);
    REQUIRE(bench.run("many", {file}).status == 0);
    check_same_run(bench, "one", "threads");
    check_same_run(bench, "one", "many");
    const std::string table = text_of(bench.out("one") / "coordinator" / "tam_events.csv");
    for (const char* other : {"threads", "many"}) {
        CHECK(text_of(bench.out(other) / "coordinator" / "tam_events.csv") == table);
        CHECK(text_of(bench.out(other) / "coordinator" / "tam_gantt.svg") ==
              text_of(bench.out("one") / "coordinator" / "tam_gantt.svg"));
    }
    const auto events = bench.csv("one", "coordinator/tam_events.csv");
    for (const char* tam : {"TAM00", "TAM01"}) {
        CAPTURE(tam);
        const double dark = when(events, tam, "leds", "000000");
        CHECK(dark > 0);
        // A task's colour, and off again behind the end of the run.
        CHECK(std::max(when(events, tam, "leds", "001900"), when(events, tam, "leds", "000019")) > dark);
        CHECK(when(events, tam, "leds", "000000", 17.0) > 0);
    }
    CHECK(when(events, "", "ended", "signal") > 17.0);
    CHECK_THAT(text_of(bench.out("one") / "coordinator.linux.log"), Contains("faults on the line 0"));
}

TEST_CASE("robots enter booths with real firmware, work and leave, and the coordinator sees it") {
    const auto real = outside("PUCKLOOP_IMAGES", "tam_firmware.elf");
    if (!real) {
        WARN("skipped: PUCKLOOP_IMAGES does not name a folder with tam_firmware.elf");
        return;
    }
    const Workbench bench;
    const std::string scenario = PUCKLOOP_SOURCE "/scenarios/tam.toml";
    const Words words{scenario, "--in-process", "--duration", "36", "--firmware", "tam=" + real->string()};
    REQUIRE(bench.run("work", words).status == 0);
    const auto events = bench.csv("work", "coordinator/tam_events.csv");
    int done = 0;
    for (const char* tam : {"TAM00", "TAM01"}) {
        const double entered = when(events, tam, "robot", "in");
        const double finished = when(events, tam, "task", "done");
        const double left = when(events, tam, "robot", "out", entered);
        if (finished < 0) continue;
        CAPTURE(tam, entered, finished, left);
        CHECK(entered > 1);
        CHECK(finished >= entered + 4);  // the shorter task
        CHECK(left > finished);
        ++done;
    }
    CHECK(done >= 1);
}

TEST_CASE("a coordinator's table that cannot be used is refused in one line") {
    const Workbench bench;
    const auto refused = [&](const std::string& coordinator, const std::string& expected) {
        const Ended ended = bench.run("bad", {bench.file("bad.toml", tams(coordinator)), "--in-process"});
        CHECK(ended.status == 2);
        CHECK_THAT(ended.err, Contains(expected));
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
    };
    const std::string program = "program = [\"puckloop-coordinator\"]\n";
    refused(program + "uart = \"script:x\"\n", "either 'program' or 'uart'");
    refused(program + "tty = \"ttyUSB0\"\n", "'ttyUSB0' is no serial port");
    refused(program + "folder = \"../there\"\n", "folder is not below the results");
    refused("program = [\"/nowhere/coordinator\"]\n", "/nowhere/coordinator");
    refused("programm = [\"x\"]\n", "programm");
}

TEST_CASE("a coordinator's parameters may come from a file beside the scenario") {
    const Workbench bench;
    bench.file("mine.toml", "experiment = \"sequence\"\norder = [\"TAM00\", \"TAM01\"]\nduration = 2.5\n");
    std::string text = tams("program = [\"puckloop-coordinator\", \"--config\", \"mine.toml\"]\n");
    text.replace(text.find("17 s"), 4, "30 s");
    REQUIRE(bench.run("mine", {bench.file("mine_too.toml", text), "--in-process"}).status == 0);
    const auto events = bench.csv("mine", "coordinator/tam_events.csv");
    CHECK(events.at(0).at("value") == "sequence");
    CHECK(when(events, "", "ended", "duration") > 2.5);  // its own end ends the run
    CHECK(bench.report("mine")["simulated_s"] < 15.0);
}

TEST_CASE("a coordinator whose TAM has died gives up on its LEDs and ends by itself") {
    const Workbench bench;
    const std::string scenario = PUCKLOOP_SOURCE "/scenarios/tam.toml";
    const Ended ended = bench.run("dead", {scenario, "--in-process", "--duration", "5", "--fault",
                                           "sag node=tam0.avr volts=1V begin=3s"});
    INFO(ended.out);
    CHECK(ended.status == 0);
    const auto report = bench.report("dead");
    CHECK(report["nodes"]["coordinator.linux"]["end"] ==
          "exited with status 0 after SIGTERM at the end of the run");
    CHECK(report["simulated_s"] > 14.9);  // it waited 10 s for the LEDs
}

TEST_CASE("a coordinator's program that fails ends with its own words") {
    const Workbench bench;
    const auto file = bench.file(
        "wrong.toml",
        tams("program = [\"puckloop-coordinator\", \"--port\", \"/dev/ttyUSB7\", \"--tasks\", \"a\"]\n"));
    const Ended ended = bench.run("wrong", {file, "--in-process"});
    CHECK(ended.status == 1);
    CHECK_THAT(ended.out + ended.err, Contains("--colors: has 2 values (expected 1, one per task)") ||
                                          Contains("coordinator.linux"));
}
