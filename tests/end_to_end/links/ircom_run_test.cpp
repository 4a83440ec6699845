// IRcom in whole runs: robots that talk to each other, and one in a TAM. Every word that a program prints was
// sent, and the run is the same however it is executed.

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

#include <cstdlib>
#include <regex>
#include <set>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kScenario = PUCKLOOP_SOURCE "/scenarios/ircom.toml";

/// Words that a robot's program printed.
std::vector<int> words_of(const Workbench& bench, const std::string& run, int robot) {
    const std::string log = text_of(bench.out(run) / ("robot" + std::to_string(robot) + ".linux.log"));
    std::vector<int> words;
    const std::regex line("infra-red word 0x([0-9a-f]{2}) from");
    for (std::sregex_iterator match(log.begin(), log.end(), line), end; match != end; ++match)
        words.push_back(std::stoi((*match)[1], nullptr, 16));
    return words;
}

}  // namespace

TEST_CASE("robots hear each other's words, and one the TAM's, in the shipped scenario") {
    const Workbench bench;
    const Ended ended = bench.run("o", {kScenario, "--in-process"});
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    // Half duplex: a word that falls into one's own is lost, and so are few more.
    const auto first = words_of(bench, "o", 0), second = words_of(bench, "o", 1),
               third = words_of(bench, "o", 2);
    CHECK(std::count(first.begin(), first.end(), 0x22) >= 6);
    CHECK(std::count(second.begin(), second.end(), 0x11) >= 4);
    CHECK(std::count(third.begin(), third.end(), 0) >=
          10);  // the own TAM firmware sends 0 until it has another
    CHECK(std::count(first.begin(), first.end(), 0x22) + 1 >= static_cast<long>(first.size()));
    CHECK(std::count(second.begin(), second.end(), 0x11) + 1 >= static_cast<long>(second.size()));
    std::map<std::string, std::set<std::string>> sent;
    int reached = 0;
    for (const Row& row : bench.csv("o", "ircom.csv")) {
        if (row.at("fault") == "short" && std::stod(row.at("end_s")) > 5.0) continue;  // the run's end
        CHECK(row.at("fault") == "none");
        sent[row.at("sender")].insert(row.at("word"));
        reached += row.at("sender") == "robot2" && row.at("receiver") == "tam0" ? 1 : 0;
    }
    CHECK(sent == std::map<std::string, std::set<std::string>>{
                      {"robot0", {"11"}}, {"robot1", {"22"}}, {"robot2", {"33"}}, {"tam0", {"00"}}});
    CHECK(reached >= 6);
    for (const auto& device : bench.report("o")["nodes"]["ircom"]["devices"])
        CHECK(device["words"] >= 6);
}

TEST_CASE("a run with IRcom is the same with any number of threads and with a process per node") {
    const Workbench bench;
    const Words common{kScenario, "--duration", "2", "--no-cache"};
    const auto run = [&](const std::string& name, Words more) {
        more.insert(more.begin(), common.begin(), common.end());
        const Ended ended = bench.run(name, more);
        INFO(ended.err);
        REQUIRE(ended.status == 0);
    };
    run("one", {"--in-process", "--threads", "1"});
    CHECK(bench.csv("one", "ircom.csv").size() > 8);
    run("two", {"--in-process", "--threads", "2"});
    check_same_run(bench, "one", "two");
    run("four", {"--in-process", "--threads", "4"});
    check_same_run(bench, "one", "four");
    run("own", {});
    check_same_run(bench, "one", "own");
}

TEST_CASE("boards whose boot is skipped see the light of their boot again, and the run is the same") {
    const Workbench bench;
    std::string text = text_of(kScenario);
    const std::string own = "firmware = \"../firmware/epuck/epuck_ircom.hex\"\n";
    for (std::size_t at = 0; (at = text.find(own, at)) != std::string::npos; at += 1)
        text.replace(at, own.size(),
                     "firmware = \"" PUCKLOOP_SOURCE
                     "/firmware/epuck/epuck_ircom.hex\"\nboot = \"900 ms\"\n");
    const auto file = bench.file("boot.toml", text);
    ::setenv("PUCKLOOP_CACHE", (bench.folder() / "cache").c_str(), 1);
    // The second resumes what the first has saved.
    const Words words{file, "--in-process", "--duration", "1.6"};
    const Ended first = bench.run("first", words), second = bench.run("second", words);
    ::setenv("PUCKLOOP_CACHE", "off", 1);
    INFO(first.err << second.err);
    REQUIRE(first.status == 0);
    REQUIRE(second.status == 0);
    CHECK(bench.report("first")["trace_sha256"] == bench.report("second")["trace_sha256"]);
    CHECK_FALSE(bench.report("first")["nodes"]["robot2.pic"].contains("resumed"));
    for (const char* board : {"robot0.pic", "robot1.pic", "robot2.pic"})
        CHECK(bench.report("second")["nodes"][board]["resumed"]["skipped"] == true);
}

TEST_CASE("without [ircom] and without TAMs there is no medium") {
    const Workbench bench;
    const Ended ended = bench.run("o", {bench.hello(), "--in-process", "--duration", "0.2"});
    CHECK_FALSE(std::filesystem::exists(bench.out("o") / "ircom.csv"));
    CHECK_FALSE(bench.report("o")["nodes"].contains("ircom"));
    const auto with = bench.file("with.toml", text_of(bench.hello("[ircom]\n")));
    (void)bench.run("w", {with, "--in-process", "--duration", "0.2"});
    CHECK(std::filesystem::exists(bench.out("w") / "ircom.csv"));
    const auto wrong = bench.file("wrong.toml", text_of(bench.hello("[ircom]\nrecrd = true\n")));
    const Ended refused = bench.run("x", {wrong, "--in-process"});
    CHECK(refused.status == 2);
    CHECK_THAT(refused.err, Contains("recrd"));
}
