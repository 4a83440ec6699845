// Runs that are judged by what their scenario expects.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kMet = R"(
[[expect]]
log = "robot0.linux"
text = "session started"
[[expect]]
link = "robot0.uart"
from = "robot0.linux"
bytes = "00 6D 02"
by = "3 s"
[[expect]]
robot = "robot0"
shape = "disc"
centre = ["0 m", "0 m"]
radius = "2 m"
[[expect]]
no_reset = "robot0.pic"
[[expect]]
log = "robot0.linux"
text = "no such line"
seen = false
)";

}  // namespace

TEST_CASE("a run that does what is expected succeeds and says so, in every placement") {
    const Workbench bench;
    const auto file = bench.hello(kMet);
    for (const Words& placement : {Words{}, Words{"--in-process"}}) {
        Words words{file,    "--duration",        "4", "--junit", bench.out("junit.xml"),
                    "--tap", bench.out("run.tap")};
        words.insert(words.end(), placement.begin(), placement.end());
        const Ended ended = bench.run("o", words);
        INFO(ended.err);
        CHECK(ended.status == 0);
        CHECK_THAT(ended.out, Contains("all 5 expectations are met"));
        const auto report = bench.report("o");
        REQUIRE(report["expectations"].size() == 5);
        for (const auto& one : report["expectations"])
            CHECK(one["met"] == true);
        CHECK(report["expectations"][1]["at_s"].get<double>() < 3.0);
        CHECK_THAT(text_of(bench.out("junit.xml")), Contains("tests=\"6\" failures=\"0\""));
        CHECK_THAT(text_of(bench.out("run.tap")), Contains("1..6\n") && !Contains("not ok"));
    }
}

TEST_CASE("what is not met fails the run with its line in the scenario, and all of it is reported") {
    const Workbench bench;
    const auto file = bench.hello(R"(
[[expect]]
link = "robot0.uart"
bytes = "00 6D 02"
seen = false
[[expect]]
robot = "robot0"
centre = ["10 m", "0 m"]
size = ["1 m", "1 m"]
by = "2 s"
)");
    const Ended ended =
        bench.run("o", {file, "--duration", "3", "--in-process", "--junit", bench.out("junit.xml")});
    check_one_line(ended, 1, {"line ", "robot0.uart never carries 00 6D 02: seen at "});
    const auto report = bench.report("o");
    CHECK(report["success"] == false);
    REQUIRE(report["failures"].size() == 2);
    CHECK(report["failures"][1]["kind"] == "expectation");
    CHECK_THAT(report["failures"][1]["text"].get<std::string>(),
               Contains("nearest at ") && Contains("m from it"));
    CHECK_THAT(text_of(bench.out("junit.xml")), Contains("tests=\"3\" failures=\"2\""));
}

TEST_CASE("expectations of what there is not are refused before the run") {
    const Workbench bench;
    const auto refused = [&bench](const std::string& table, const Words& words) {
        const auto file = bench.hello("[[expect]]\n" + table);
        check_one_line(bench.run("o", {file, "--duration", "1"}), 2, words);
    };
    refused("no_reset = \"robot0.pik\"\n", {"line ", "there is no board 'robot0.pik'", "robot0.pic"});
    refused("board = \"robot0.linux\"\nholds = \"A == 1\"\n",
            {"there is no board 'robot0.linux'", "robot0.pic"});
    refused("board = \"robot0.pic\"\nholds = \"TRISDD == 1\"\n", {"line ", "no register 'TRISDD'", "TRISD"});
    refused("board = \"robot0.pic\"\nholds = \"TRISD\"\n", {"line ", "'TRISD' compares nothing"});
    refused("frame = \"epuk\"\n", {"there is no protocol 'epuk'", "epuck"});
    refused("no_loss = \"robot0.i2c\"\n", {"there is no serial line 'robot0.i2c'", "robot0.uart"});
    refused("link = \"robot0.i2c\"\nbytes = \"00\"\n", {"there is no serial line 'robot0.i2c'"});
    refused("link = \"robot0.uart\"\nbytes = \"00\"\nfrom = \"linux\"\n",
            {"there is no end of that line 'linux'", "one of robot0.linux, robot0.pic"});
    refused("robot = \"robo0\"\ncentre = [\"0 m\", \"0 m\"]\nsize = [\"1 m\", \"1 m\"]\n",
            {"there is no robot 'robo0'", "robot0"});
    check_one_line(bench.run("o", {bench.hello(), "--duration", "1", "--junit", "/nowhere/x.xml"}), 2,
                   {"/nowhere/x.xml"});
}

TEST_CASE("values of a chip, decoded frames and lost characters are expected, in every placement") {
    const Workbench bench;
    // The coils of the motors are outputs at port D once the program is awake; nothing overruns.
    const auto file = bench.hello(R"(
[[expect]]
board = "robot0.pic"
holds = "LATD != 0"
after = "1 s"
by = "3 s"
every = "100 us"
[[expect]]
board = "robot0.pic"
holds = "U2STA.OERR == 1"
seen = false
[[expect]]
frame = "epuck"
from = "robot0.linux"
has = { record = "actuators" }
at_least = 5
by = "3 s"
[[expect]]
frame = "fault"
seen = false
[[expect]]
no_loss = "robot0.uart"
)");
    std::string seen, trace;
    for (const Words& placement : {Words{"--in-process"}, Words{}}) {
        Words words{file, "--duration", "3"};
        words.insert(words.end(), placement.begin(), placement.end());
        const Ended ended = bench.run("o", words);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
        const auto report = bench.report("o");
        CHECK(report["expectations"][0]["at_s"].get<double>() > 1.0);
        if (seen.empty()) seen = report["expectations"].dump();
        CHECK(report["expectations"].dump() == seen);
        trace = report["trace_sha256"];
    }
    // To look changes nothing.
    const auto plain = bench.hello();
    REQUIRE(bench.run("p", {plain, "--duration", "3", "--in-process"}).status == 0);
    CHECK(bench.report("p")["trace_sha256"] == trace);
}

TEST_CASE("of values, frames and losses that are not met it is said what there was") {
    const Workbench bench;
    const auto file = bench.hello(R"(
[[expect]]
board = "robot0.pic"
holds = "TRISD == 0x1234"
by = "1500 ms"
[[expect]]
frame = "epuck"
has = { record = "actuators", left = 12345 }
[[expect]]
frame = "ip"
[[expect]]
no_loss = "robot0.uart"
)");
    const Ended ended = bench.run("o", {file, "--duration", "2", "--in-process", "--fault",
                                        "drop link=robot0.uart from=robot0.linux begin=1.5s count=2"});
    CHECK(ended.status == 1);
    const auto all = bench.report("o")["expectations"];
    REQUIRE(all.size() == 4);
    const auto why = [&](std::size_t i) { return all[i]["why"].get<std::string>(); };
    CHECK_THAT(why(0), Contains("it was ") && Contains("at 1.500000 s, the last look"));
    CHECK_THAT(why(1), Contains("0 of ") && Contains("frames fit, the last was "));
    CHECK(why(2) == "no ip frame came");
    CHECK_THAT(why(3), Contains("2 from robot0.linux.uart harmed by faults"));
    for (const auto& one : all)
        CHECK(one["met"] == false);
}

TEST_CASE(
    "a value that is looked for goes with a client, a debugger's past and snapshots, not with saved states") {
    const Workbench bench;
    const auto file = bench.hello(R"(
[[expect]]
board = "robot0.pic"
holds = "LATD != 0"
after = "1 s"
)");
    REQUIRE(bench.run("a", {file, "--duration", "3", "--in-process"}).status == 0);
    const auto whole = bench.report("a")["expectations"];
    const std::string saved = bench.out("run.snapshot");
    REQUIRE(bench.run("b", {file, "--duration", "3", "--in-process", "--save-at", "2s", "--save", saved})
                .status == 0);
    REQUIRE(bench.run("c", {"--from", saved, "--in-process"}).status == 0);
    CHECK(bench.report("c")["expectations"] == whole);
    check_one_line(bench.run("d", {file, "--duration", "3", "--save-state", bench.out("s"), "--at", "2s"}), 2,
                   {"line ", "saved states"});
}
