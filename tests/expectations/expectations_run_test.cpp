// Runs that are judged by what their scenario expects.

#include "tests/end_to_end/one_line.h"
#include "tests/end_to_end/workbench.h"

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
    refused("no_reset = \"robot0.pik\"\n", {"line ", "there is no node 'robot0.pik'", "robot0.pic"});
    refused("link = \"robot0.i2c\"\nbytes = \"00\"\n", {"there is no serial line 'robot0.i2c'"});
    refused("link = \"robot0.uart\"\nbytes = \"00\"\nfrom = \"linux\"\n", {"there is no node 'linux'"});
    refused("robot = \"robo0\"\ncentre = [\"0 m\", \"0 m\"]\nsize = [\"1 m\", \"1 m\"]\n",
            {"there is no robot 'robo0'", "robot0"});
    check_one_line(bench.run("o", {bench.hello(), "--duration", "1", "--junit", "/nowhere/x.xml"}), 2,
                   {"/nowhere/x.xml"});
}
