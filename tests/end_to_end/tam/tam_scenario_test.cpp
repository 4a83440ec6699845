// scenarios/tam.toml: two robots, two TAMs, a coordinator; and what is refused about TAMs, in one line.

#include "tests/end_to_end/kit/one_line.h"
#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"
#include "tests/end_to_end/tam/tam_visits.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <map>
#include <set>

using namespace puckloop::tests;

namespace {

const std::string kScenario = PUCKLOOP_SOURCE "/scenarios/tam.toml";

}  // namespace

TEST_CASE("two robots find two TAMs and work and talk in them, the same in every placement") {
    const Workbench bench;
    const Ended ended = bench.run("one", {kScenario, "--duration", "56", "--in-process", "--no-cache"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK(bench.report("one")["warnings"].empty());
    const auto visits = visits_of(bench, "one", 2);
    for (const RobotVisits& robot : visits) {
        REQUIRE_FALSE(robot.entered.empty());
        CHECK(robot.entered.front() > 10);  // it had to look for it
        CHECK(robot.left);
        CHECK((robot.heard.contains(0x11) ||
               robot.heard.contains(0x22)));  // the coordinator's, through the TAM
    }
    std::set<std::string> reported;
    for (const auto& [tam, words] : values_of(bench, "one", "heard"))
        reported.insert(words.begin(), words.end());
    CHECK(reported.contains("a0"));
    CHECK(reported.contains("a1"));
    for (const char* tam : {"TAM00", "TAM01"}) {
        INFO(tam);
        const auto times = [&](const char* event, const char* value) {
            const auto values = values_of(bench, "one", event)[tam];
            return std::count(values.begin(), values.end(), value);
        };
        CHECK(times("robot", "in") >= 1);
        CHECK(times("robot", "out") >= 2);  // the first is that nobody is there
        CHECK(times("task", "done") >= 1);
        CHECK(times("task", "aborted") == 0);
        CHECK(times("timeout", "set_leds") == 0);
    }
    const auto nodes = bench.report("one")["nodes"];
    for (const char* tam : {"tam0.avr", "tam1.avr"}) {
        CHECK(nodes[tam]["interruptions"]["front"] >= 2);
        CHECK(nodes[tam]["interruptions"]["back"] >= 1);
        CHECK(nodes[tam]["unmodelled"].empty());
        CHECK(nodes[tam]["powered"] == true);
    }
    std::set<std::string> senders;
    for (const Row& row : bench.csv("one", "ircom.csv")) {
        CHECK(row.at("fault") == "none");
        senders.insert(row.at("sender"));
    }
    CHECK(senders == std::set<std::string>{"robot0", "robot1", "tam0", "tam1"});
    const std::string picture = text_of(bench.out("one") / "trajectory.svg");
    for (const char* word : {">tam0<", ">tam1<", "#eb0000"})  // both, and a busy one is red
        CHECK_THAT(picture, Catch::Contains(word));
    CHECK_THAT(text_of(bench.out("one") / "coordinator/tam_gantt.svg"), Catch::Contains("TAM01"));

    // Until words have crossed in a booth, both ways.
    const auto shorter = [&](const std::string& name, const Words& ways) {
        Words words{kScenario, "--duration", "20", "--no-cache"};
        words.insert(words.end(), ways.begin(), ways.end());
        REQUIRE(bench.run(name, words).status == 0);
    };
    shorter("two", {"--in-process", "--threads", "2"});
    CHECK(bench.csv("two", "ircom.csv").size() > 8);
    shorter("four", {"--in-process", "--threads", "4"});
    shorter("own", {});
    for (const char* name : {"four", "own"}) {
        check_same_run(bench, "two", name);
        for (const char* file : {"tams.csv", "coordinator/tam_events.csv", "robot0.linux.log"})
            CHECK(text_of(bench.out("two") / file) == text_of(bench.out(name) / file));
    }
}

TEST_CASE("what is wrong with a TAM is refused in one line, before the run") {
    const Workbench bench;
    const auto refused = [&](const std::string& tam, const std::string& word, const Words& more = {}) {
        const auto file =
            bench.file("bad.toml", "[run]\nduration = \"1 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n"
                                   "[[tam]]\nposition = [\"0 m\", \"0 m\"]\n" +
                                       tam);
        Words words{file};
        words.insert(words.end(), more.begin(), more.end());
        check_one_line(bench.run("o", words), 2, {word});
    };
    const std::string epuck = "tam0=" PUCKLOOP_SOURCE "/firmware/epuck/epuck";
    refused("network = 4\n", "bad.toml: line 7: tam0: network is out of range");
    refused("firmware = \"no.elf\"\n", "no.elf: no such file");
    refused("", "epuck.elf", {"--firmware", epuck + ".elf"});
    refused("", "past the flash of the atmega1284p", {"--firmware", epuck + ".hex"});
    refused("boot_loader = \"bad.toml\"\n", "bad.toml");
    refused("console = \"pty\"\n", "tam0.console");
    refused("[[tam]]\nposition = [\"5 cm\", \"0 m\"]\n", "overlaps tam 'tam0'");
}

TEST_CASE("a TAM's board is saved and resumed like the others") {
    const Workbench bench;
    const auto file = bench.file("tam.toml", "[run]\nduration = \"4 s\"\n[arena]\nsize = [\"1 m\", \"1 m\"]\n"
                                             "[coordinator]\n[[tam]]\nposition = [\"0 m\", \"0 m\"]\n");
    REQUIRE(bench.run("whole", {file}).status == 0);
    const std::string state = (bench.folder() / "state").string();
    REQUIRE(bench.run("save", {file, "--save-state", state, "--at", "2.5s"}).status == 0);
    const Ended resumed = bench.run("resumed", {file, "--from-state", state});
    INFO(resumed.err);
    REQUIRE(resumed.status == 0);
    CHECK(bench.report("resumed")["nodes"]["tam0.avr"]["resumed"]["at_s"] == 2.5);
    check_same_run(bench, "whole", "save");
    check_same_run(bench, "whole", "resumed");
    CHECK(text_of(bench.out("whole") / "tam0.avr.log") == text_of(bench.out("resumed") / "tam0.avr.log"));
}
