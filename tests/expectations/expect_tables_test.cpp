// [[expect]] tables as they are read.

#include "base/error.h"
#include "scenarios/reader/read_scenario.h"
#include "tests/scenarios/temporary_file.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::scenarios;
using Catch::Contains;

namespace {

Scenario expecting(const std::string& tables) {
    const TemporaryFile file("[run]\nduration = \"1 s\"\n[arena]\nsize = [\"2 m\", \"2 m\"]\n[[robot]]\n"
                             "position = [\"0 m\", \"0 m\"]\n[robot.pic]\nfirmware = \"own\"\n" +
                             tables);
    return read_scenario(file.path());
}

std::string refused(const std::string& keys) {
    try {
        expecting("[[expect]]\n" + keys);
    } catch (const InputError& error) {
        return error.what();
    }
    return "accepted";
}

}  // namespace

TEST_CASE("an expectation is a table of one of four kinds, with a name made from its keys") {
    const auto all =
        expecting("[[expect]]\nlog = \"robot0.linux\"\ntext = \"ready\"\nseen = false\n"
                  "[[expect]]\nlink = \"robot0.uart\"\nbytes = \"56 0d\"\nfrom = \"robot0.linux\"\n"
                  "after = \"1 s\"\nby = \"2500 ms\"\n"
                  "[[expect]]\nrobot = \"robot0\"\nshape = \"disc\"\ncentre = [\"50 cm\", \"0 m\"]\n"
                  "radius = \"20 cm\"\n"
                  "[[expect]]\nno_reset = \"robot0.pic\"\nname = \"it stays up\"\n")
            .expectations;
    REQUIRE(all.size() == 4);
    CHECK(all[0].kind == Expectation::Kind::Log);
    CHECK(all[0].name == "the log of robot0.linux has no 'ready'");
    CHECK_FALSE(all[0].seen);
    CHECK(all[1].text == "V\r");
    CHECK(all[1].after == 1.0);
    CHECK(all[1].by == 2.5);
    CHECK(all[1].name == "robot0.uart carries 56 0d from robot0.linux, after 1 s, by 2.5 s");
    CHECK(all[2].region.holds({0.65, 0.1}));
    CHECK_FALSE(all[2].region.holds({0.65, 0.15}));
    CHECK(std::isinf(all[2].by));
    CHECK(all[3].name == "it stays up");
    CHECK(all[3].place == "line 24");
}

TEST_CASE("an expectation that says too little or too much is one line with its place") {
    CHECK_THAT(refused("seen = true\n"), Contains("line 9") && Contains("'log' is missing"));
    CHECK_THAT(refused("log = \"a\"\ntext = \"b\"\nrobot = \"c\"\n"), Contains("robot goes with no log"));
    CHECK_THAT(refused("log = \"a\"\n"), Contains("'text' is missing"));
    CHECK_THAT(refused("log = \"a\"\ntext = \"\"\n"), Contains("a text of one line"));
    CHECK_THAT(refused("link = \"a\"\nbytes = \"5\"\n"),
               Contains("line 11") && Contains("two digits a byte"));
    CHECK_THAT(refused("link = \"a\"\nbytes = \"xy\"\n"), Contains("not hexadecimal"));
    CHECK_THAT(refused("link = \"a\"\nbytes = \"00\"\nafter = \"2 s\"\nby = \"1 s\"\n"),
               Contains("by is before after"));
    CHECK_THAT(refused("robot = \"a\"\nradius = \"1 m\"\n"), Contains("'centre' is missing"));
    CHECK_THAT(refused("robot = \"a\"\ncentre = [\"0 m\", \"0 m\"]\nshape = \"disc\"\nradius = \"0 m\"\n"),
               Contains("radius is out of range"));
    CHECK_THAT(refused("no_reset = \"a\"\nby = \"1 s\"\n"), Contains("by"));
    CHECK_THAT(refused("log = \"a\"\ntext = \"b\"\nafter = \"1 s\"\n"), Contains("after"));
}
