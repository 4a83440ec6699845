// scenarios/tam.toml: two robots, two TAMs, a coordinator; and what is refused about TAMs, in one line.

#include "tests/end_to_end/one_line.h"
#include "tests/end_to_end/same_run.h"
#include "tests/end_to_end/workbench.h"

#include <catch2/catch.hpp>

#include <map>

using namespace puckloop::tests;

namespace {

const std::string kScenario = PUCKLOOP_SOURCE "/scenarios/tam.toml";

/// The coordinator's table as (event, value) pairs of each TAM, in order.
std::map<std::string, std::vector<std::pair<std::string, std::string>>> events_of(const Workbench& bench,
                                                                                  const std::string& run) {
    std::map<std::string, std::vector<std::pair<std::string, std::string>>> events;
    for (const Row& row : bench.csv(run, "coordinator/tam_events.csv"))
        events[row.at("tam")].emplace_back(row.at("event"), row.at("value"));
    return events;
}

}  // namespace

TEST_CASE("two robots work at two TAMs for their coordinator, the same in every placement") {
    const Workbench bench;
    const Ended ended = bench.run("one", {kScenario, "--duration", "46", "--in-process", "--no-cache"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    CHECK(bench.report("one")["warnings"].empty());
    auto events = events_of(bench, "one");
    for (const char* tam : {"TAM01", "TAM02"}) {
        INFO(tam);
        const auto& own = events[tam];
        const auto count = [&](const char* event, const char* value) {
            return std::count(own.begin(), own.end(), std::pair<std::string, std::string>(event, value));
        };
        CHECK(count("robot", "in") >= 2);
        CHECK(count("robot", "out") >= 1);
        CHECK(count("task", "done") >= 2);
        CHECK(count("task", "aborted") == 0);
        CHECK(count("timeout", "set_leds") == 0);
    }
    const auto nodes = bench.report("one")["nodes"];
    for (const char* tam : {"tam0.avr", "tam1.avr"}) {
        CHECK(nodes[tam]["interruptions"]["back"] >= 2);
        CHECK(nodes[tam]["unmodelled"].empty());
        CHECK(nodes[tam]["powered"] == true);
    }
    const std::string picture = text_of(bench.out("one") / "trajectory.svg");
    for (const char* word : {">tam0<", ">tam1<", "#eb0000"})  // both, and a busy one is red
        CHECK_THAT(picture, Catch::Contains(word));
    CHECK_THAT(text_of(bench.out("one") / "coordinator/tam_gantt.svg"), Catch::Contains("TAM02"));

    for (const char* name : {"two threads", "many"}) {
        Words words{kScenario, "--duration", "12", "--no-cache"};
        if (name == std::string("two threads")) words.insert(words.end(), {"--in-process", "--threads", "2"});
        REQUIRE(bench.run(name, words).status == 0);
    }
    check_same_run(bench, "two threads", "many");
    CHECK(text_of(bench.out("two threads") / "tams.csv") == text_of(bench.out("many") / "tams.csv"));
}

TEST_CASE("what is wrong with a TAM is said in one line, before the run") {
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
