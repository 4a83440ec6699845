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

TEST_CASE("an expectation is a table of one of seven kinds, with a name made from its keys") {
    const auto all =
        expecting("[[expect]]\nlog = \"robot0.linux\"\ntext = \"ready\"\nseen = false\n"
                  "[[expect]]\nlink = \"robot0.uart\"\nbytes = \"56 0d\"\nfrom = \"robot0.linux\"\n"
                  "after = \"1 s\"\nby = \"2500 ms\"\n"
                  "[[expect]]\nrobot = \"robot0\"\nshape = \"disc\"\ncentre = [\"50 cm\", \"0 m\"]\n"
                  "radius = \"20 cm\"\n"
                  "[[expect]]\nno_reset = \"robot0.pic\"\nname = \"it stays up\"\n"
                  "[[expect]]\nboard = \"robot0.pic\"\nholds = \"U2STA.OERR == 1\"\nseen = false\n"
                  "every = \"10 us\"\n"
                  "[[expect]]\nframe = \"epuck\"\nfrom = \"robot0.linux\"\nat_least = 3\n"
                  "has = { record = \"actuators\", left = -5, x = 0.5, ok = true }\ntext = \"wheels\"\n"
                  "[[expect]]\nno_loss = \"robot0.uart\"\n")
            .expectations;
    REQUIRE(all.size() == 7);
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
    CHECK(all[3].stated == "robot0.pic starts once");
    CHECK(all[3].place == "line 24");
    CHECK(all[4].name == "robot0.pic never has U2STA.OERR == 1");
    CHECK(all[4].every == Approx(1e-5));
    CHECK(all[5].name ==
          "3 epuck frames with left=-5, ok=true, record=actuators, x=0.5 'wheels' come from robot0.linux");
    CHECK(all[5].at_least == 3);
    CHECK(all[5].has.size() == 4);
    CHECK(all[6].name == "robot0.uart loses nothing");
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
    CHECK_THAT(refused("board = \"a\"\n"), Contains("'holds' is missing"));
    CHECK_THAT(refused("board = \"a\"\nholds = \"b == 1\"\nevery = \"0 s\"\n"),
               Contains("every is out of range"));
    CHECK_THAT(refused("frame = \"rab\"\nhas = { a = [1] }\n"), Contains("a is no text, number"));
    CHECK_THAT(refused("frame = \"rab\"\nseen = false\nat_least = 2\n"),
               Contains("at_least goes with no seen = false"));
    CHECK_THAT(refused("no_loss = \"a\"\nseen = true\n"), Contains("seen"));
    CHECK_THAT(refused("no_reset = \"a\"\nby = \"1 s\"\n"), Contains("by"));
    CHECK_THAT(refused("log = \"a\"\ntext = \"b\"\nafter = \"1 s\"\n"), Contains("after"));
}
