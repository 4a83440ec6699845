// Serial faults and restarts in mid-session: the mission goes on, with either firmware.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <utility>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

/// The robot drives on after `from_s`, and stays off the walls.
void check_goes_on(const Workbench& bench, const std::string& name, double from_s) {
    INFO(name);
    const auto trajectory = bench.csv(name, "trajectory.csv");
    const Journey after = journey(trajectory, from_s);
    CHECK(after.length > 0.03 * (after.last_s - from_s));  // the behaviour drives at about 6 cm/s
    CHECK(after.clearance > 0.0);
}

std::string log_of(const Workbench& bench, const std::string& name) {
    return text_of(bench.out(name) / "robot0.linux.log");
}

std::string fault(const std::string& lines) {
    return "\n[[fault]]\nlink = \"robot0.uart\"\n" + lines;
}

/// `key = value` in the table `[robot.pic]` or `[robot.linux]` of a scenario's text.
std::string with(std::string text, const std::string& table, const std::string& line) {
    const std::string header = "[" + table + "]\n";
    return text.insert(text.find(header) + header.size(), line + "\n");
}

}  // namespace

TEST_CASE("lost, garbled and late bytes do not end the mission") {
    const auto [name, lines] = GENERATE(table<std::string, std::string>(
        {{"drop", "kind = \"drop\"\nprobability = 0.01\nbegin = \"2 s\"\nend = \"5 s\"\n"},
         {"flip", "kind = \"flip\"\nprobability = 0.01\nbegin = \"2 s\"\nend = \"5 s\"\n"},
         {"late",
          "kind = \"delay\"\ndelay = \"30 ms\"\nprobability = 0.01\nbegin = \"2 s\"\nend = \"5 s\"\n"},
         {"silence", "kind = \"disconnect\"\nbegin = \"2 s\"\nend = \"4 s\"\n"}}));
    const Workbench bench;
    const std::string scenario = bench.hello(fault(lines));
    REQUIRE(bench.run(name, {scenario, "--duration", "12", "--in-process"}).status == 0);
    const auto report = bench.report(name);
    REQUIRE(report["faults"].size() == 1);
    CHECK(report["faults"][0]["fired"] > 0);
    CHECK(report["warnings"].empty());
    check_goes_on(bench, name, 7.0);
    if (name != "flip")
        CHECK_THAT(log_of(bench, name), Contains("re-synchronising") && Contains("in step again"));
}

TEST_CASE("faults are the same in one process and in many") {
    const Workbench bench;
    const std::string scenario = bench.hello(
        fault("kind = \"drop\"\nprobability = 0.002\n") + fault("kind = \"flip\"\nprobability = 0.002\n") +
        fault("kind = \"insert\"\np = 0.002\nr = 0.3\n") + fault("kind = \"swap\"\nevery = 211\n") +
        fault("kind = \"unplug\"\nbegin = \"1.3 s\"\nfor = \"300 ms\"\n") +
        fault(
            "kind = \"delay\"\ndelay = \"1 ms\"\njitter = \"1 ms\"\nbegin = \"1.6 s\"\nprobability = 0.1\n"));
    REQUIRE(bench.run("one", {scenario, "--duration", "5", "--in-process"}).status == 0);
    REQUIRE(bench.run("many", {scenario, "--duration", "5"}).status == 0);
    check_same_run(bench, "one", "many");
    CHECK(bench.report("one")["faults"] == bench.report("many")["faults"]);
    CHECK(text_of(bench.out("one") / "faults.csv") == text_of(bench.out("many") / "faults.csv"));
}

TEST_CASE("a run whose fault never fired has failed, unless that is allowed") {
    const Workbench bench;
    const std::string never = bench.hello(fault("begin = \"1 h\"\n"));
    const Ended ended = bench.run("o", {never, "--duration", "1", "--in-process"});
    CHECK(ended.status == 1);
    CHECK_THAT(ended.err, Contains("fault robot0.uart.drop never fired: drop on robot0.uart") &&
                              Contains("its window begins at 3600.000 s and the run ended at 1.0") &&
                              Contains("may_not_fire"));
    const Ended parity =
        bench.run("o", {bench.hello(fault("kind = \"parity\"\n")), "--duration", "1.2", "--in-process"});
    CHECK(parity.status == 1);
    CHECK_THAT(parity.err, Contains("frames without a parity bit are no candidates"));
    CHECK(bench.report("o")["success"] == false);
    CHECK(bench.report("o")["faults"][0]["fired"] == 0);
    const Ended held = bench.run("o", {bench.hello(), "--duration", "1.2", "--in-process", "--fault",
                                       "kill node=robot0.linux at=1ms"});
    CHECK(held.status == 1);
    CHECK_THAT(held.err, Contains("its program was not running then"));
    // A line that is low on a bus at rest is there for all to see.
    const Ended rest = bench.run("q", {bench.hello(), "--duration", "1.2", "--in-process", "--fault",
                                       "sda link=robot0.i2c at=1ms time=1ms"});
    CHECK(rest.status == 0);
    CHECK(bench.report("q")["faults"][0]["fired"] == 1);
    CHECK_THAT(bench.report("q")["faults"][0]["firings"][0]["what"].get<std::string>(),
               Contains("on a bus at rest"));
    const std::string allowed = bench.hello(fault("begin = \"1 h\"\nmay_not_fire = true\nname = \"late\"\n"));
    REQUIRE(bench.run("p", {allowed, "--duration", "1", "--in-process"}).status == 0);
    CHECK(bench.report("p")["faults"][0]["name"] == "late");
    CHECK(bench.report("p")["warnings"].empty());
}

TEST_CASE("a program whose serial port fails prints why it ends") {
    const Workbench bench;
    const Ended ended = bench.run("o", {bench.hello(), "--duration", "2.5", "--in-process", "--fault",
                                        "write_error node=robot0.linux errno=EIO begin=2s count=1"});
    CHECK(ended.status == 1);
    CHECK_THAT(ended.err, Contains("/dev/ttyS0: Input/output error") && !Contains("does not answer"));
}

TEST_CASE("a fault of the command line is one of the scenario, with the same evidence") {
    const Workbench bench;
    REQUIRE(bench
                .run("words", {bench.hello(), "--duration", "4", "--fault",
                               "drop link=robot0.uart from=robot0.linux at=2s count=3 every=5 skip=7"})
                .status == 0);
    const std::string table =
        bench.hello(fault("from = \"robot0.linux\"\nat = \"2 s\"\ncount = 3\nevery = 5\nskip = 7\n"));
    const Ended from_table = bench.run("table", {table, "--duration", "4", "--in-process"});
    REQUIRE(from_table.status == 0);
    CHECK_THAT(from_table.out,
               Contains("fault robot0.uart.drop: fired 3 times, first at 2.") && Contains("(0x"));
    const auto a = bench.report("table"), b = bench.report("words");
    CHECK(a["trace_sha256"] == b["trace_sha256"]);
    CHECK(a["faults"] == b["faults"]);
    CHECK(text_of(bench.out("table") / "faults.csv") == text_of(bench.out("words") / "faults.csv"));
    const auto& firings = a["faults"][0]["firings"];
    REQUIRE(firings.size() == 3);
    // Each is in the trace where the evidence states.
    int found = 0;
    for (const Row& row : bench.csv("table", "trace.csv"))
        if (row.at("fault") == "drop") {
            CHECK(std::stod(row.at("start_s")) * 1e12 ==
                  Approx(firings[found]["time_ps"].get<double>()).margin(2));
            CHECK("0x" + row.at("value") == firings[found]["what"].get<std::string>());
            ++found;
        }
    CHECK(found == 3);
    CHECK(firings[1]["index"].get<int>() == firings[0]["index"].get<int>() + 5);
    const std::string plain = bench.hello();
    for (const char* words : {"", "drop", "drop link", "drop link=robot0.uart link=robot0.uart",
                              "drop link=robot1.uart", "drop link=robot0.uart at=2", "dorp link=robot0.uart",
                              "drop link=robot0.uart factor=2", "rate link=robot0.uart", "drop =3"}) {
        INFO(words);
        const Ended ended = bench.run("x", {plain, "--fault", words});
        CHECK(ended.status == 2);
        CHECK(std::count(ended.err.begin(), ended.err.end(), '\n') == 1);
    }
}

TEST_CASE("the session recovers when either side starts again") {
    const Workbench bench;
    const std::string hello = text_of(bench.hello());
    const std::string pic = bench.file("pic.toml", with(hello, "robot.pic", "reset = [\"4 s\", \"6 s\"]"));
    const std::string program = bench.file("linux.toml", with(hello, "robot.linux", "restart = [\"4 s\"]"));
    for (const std::string& scenario : {pic, program}) {
        const std::string name = std::filesystem::path(scenario).stem();
        REQUIRE(bench.run(name, {scenario, "--duration", "12", "--in-process"}).status == 0);
        REQUIRE(bench.run(name + " many", {scenario, "--duration", "12"}).status == 0);
        check_same_run(bench, name, name + " many");
        check_goes_on(bench, name, 8.0);
    }
    const auto resets = bench.report("pic")["nodes"]["robot0.pic"]["resets"];
    REQUIRE(resets.size() == 3);
    CHECK(resets[1]["cause"] == "EXTR");
    CHECK(resets[1]["time_s"].get<double>() == Approx(4.0));
    CHECK_THAT(log_of(bench, "pic"), Contains("re-synchronising"));
    CHECK(bench.report("linux")["nodes"]["robot0.linux"]["starts"] == 2);
    CHECK_THAT(log_of(bench, "linux"), Contains("session started"));
}

TEST_CASE("reset times that do not rise are refused with their line") {
    const Workbench bench;
    const std::string hello = text_of(bench.hello());
    for (const char* times : {"[\"6 s\", \"4 s\"]", "[\"0 s\"]", "[\"6 m\"]"}) {
        const std::string file =
            bench.file("x.toml", with(hello, "robot.pic", std::string("reset = ") + times));
        const Ended ended = bench.run("o", {file});
        CHECK(ended.status == 2);
        CHECK_THAT(ended.err, Contains("line ") && Contains("reset"));
    }
}

TEST_CASE("with the original firmware the session recovers too") {
    const auto image = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    if (!image) {
        WARN("PUCKLOOP_IMAGES has no epuck_firmware.hex: skipped");
        return;
    }
    const Workbench bench;
    std::string text = text_of(PUCKLOOP_SOURCE "/scenarios/own_binaries.toml");
    text = with(text, "robot.pic", "reset = [\"70 s\"]");
    text = with(text, "robot.linux", "restart = [\"48 s\"]");
    const std::string relative = "../firmware";
    text.replace(text.find(relative), relative.size(), PUCKLOOP_SOURCE "/firmware");
    text += fault("probability = 0.01\nbegin = \"55 s\"\nend = \"60 s\"\n");
    const std::string scenario = bench.file("own.toml", text);
    // After the reset this firmware boots again for 40 s; then the program finds it.
    const Words words{scenario,
                      "--firmware",
                      "robot0.pic=" + image->string(),
                      "--in-process",
                      "--duration",
                      "125",
                      "--linux",
                      "puckloop-control",
                      "--",
                      "--duration",
                      "100",
                      "--give-up",
                      "60"};
    const Ended ended = bench.run("o", words);
    INFO(ended.err);
    INFO(log_of(bench, "o"));
    REQUIRE(ended.status == 0);
    const auto trajectory = bench.csv("o", "trajectory.csv");
    std::vector<Row> until_reset, rest;
    for (const Row& row : trajectory)
        (std::stod(row.at("t_s")) < 70.0 ? until_reset : rest).push_back(row);
    CHECK(journey(until_reset, 50.0).length > 0.15);  // after the program's restart
    CHECK(journey(until_reset, 62.0).length > 0.1);   // after the faults
    CHECK(journey(rest, 115.0).length > 0.2);         // after the PIC's restart
    CHECK_THAT(log_of(bench, "o"), Contains("re-synchronising") && Contains("in step again"));
}

TEST_CASE("ends that hear themselves to the very end of a run make one trace in every placement") {
    // A board that waited for its own character at the instant of sending it once stood still, now and then.
    const Workbench bench;
    const Words words{
        bench.hello(), "--duration", "3", "--fault", "loopback link=robot0.uart at=2s for=1s through=true",
        "--no-cache"};
    const auto trace = [&](const std::string& name, const Words& more) {
        Words all = words;
        all.insert(all.end(), more.begin(), more.end());
        const Ended ended = bench.run(name, all);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const auto report = bench.report(name);
        CHECK(report["faults"][0]["fired"] > 100);
        return report["trace_sha256"].get<std::string>();
    };
    const std::string one = trace("one", {"--in-process"});
    for (const std::string name : {"many1", "many2", "many3"})
        CHECK(trace(name, {}) == one);
}
