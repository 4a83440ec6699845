// Several robots with range-and-bearing boards: scenarios/rab_pair.toml, swarm.toml and own_rab.toml, the
// last with the boards' original firmware (PUCKLOOP_IMAGES) and ARGoS's real-robot program (PUCKLOOP_ARGOS).

#include "tests/end_to_end/kit/same_run.h"
#include "tests/end_to_end/kit/workbench.h"

#include <catch2/catch.hpp>

using namespace puckloop::tests;
using Catch::Contains;

namespace {

const std::string kScenarios = PUCKLOOP_SOURCE "/scenarios/";

/// `puckloop trace rab` of a run's results.
nlohmann::json losses_of(const Workbench& bench, const std::string& name, const Words& more = {}) {
    Words words{"trace", "rab", bench.out(name), "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Ended ended = bench.puckloop(words);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    return nlohmann::json::parse(ended.out);
}

}  // namespace

TEST_CASE("two robots with boards leave the same bytes in one process and in many") {
    const Workbench bench;
    for (const char* name : {"one", "one again"})
        REQUIRE(bench.run(name, {kScenarios + "rab_pair.toml", "--duration", "1.2", "--in-process"}).status ==
                0);
    REQUIRE(bench.run("many", {kScenarios + "rab_pair.toml", "--duration", "1.2"}).status == 0);
    check_same_run(bench, "one", "one again");
    check_same_run(bench, "one", "many");
    CHECK(bench.report("one")["warnings"].empty());

    const auto losses = losses_of(bench, "one");
    CHECK(losses["groups"][0]["frames"] > 60);
    CHECK(losses["groups"][0]["share"] > 0.8);  // own firmware and own driver keep out of each other's way
    for (const char* robot : {"leader", "follower"}) {
        CHECK(losses["boards"][robot]["messages"] > 20);
        CHECK(losses["boards"][robot]["unexplained_messages"] == 0);
    }
    const Ended text = bench.puckloop({"trace", "rab", bench.out("one")});
    CHECK_THAT(text.out, Contains("follower -> leader") && Contains("published model"));
    CHECK_THAT(text_of(bench.out("one") / "trajectory.svg"), Contains("leader") && Contains("follower"));
}

TEST_CASE("a run ends when the last of its programs has") {
    const Workbench bench;
    Words words{kScenarios + "rab_pair.toml", "--in-process", "--duration", "5"};
    words.insert(words.end(),
                 {"--linux", "puckloop-control", "--", "--behaviour", "still", "--duration", "0.5"});
    const Ended ended = bench.run("o", words);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto report = bench.report("o");
    CHECK(report["ended_by"] == "node stopped");
    CHECK(report["simulated_s"] > 0.55);
    CHECK(report["simulated_s"] < 1.5);
    for (const char* program : {"leader.linux", "follower.linux"})
        CHECK_THAT(report["nodes"][program]["end"].get<std::string>(), Contains("status 0"));
}

TEST_CASE("eight robots hear each other") {
    const Workbench bench;
    REQUIRE(bench.run("o", {kScenarios + "swarm.toml", "--in-process", "--duration", "0.6"}).status == 0);
    const auto losses = losses_of(bench, "o");
    CHECK(losses["boards"].size() == 8);
    CHECK(losses["groups"][0]["delivered"] > 8);
    CHECK(bench.report("o")["warnings"].empty());
}

TEST_CASE("results without range-and-bearing boards are refused") {
    const Workbench bench;
    const Ended ended = bench.puckloop({"trace", "rab", bench.folder()});
    CHECK(ended.status == 2);
    CHECK_THAT(ended.err, Contains("ir.csv") && Contains("range-and-bearing"));
    CHECK(ended.error_lines() == 1);
}

TEST_CASE("ARGoS's real-robot program and the board's original firmware lose frames by themselves",
          "[argos]") {
    const auto pic = outside("PUCKLOOP_IMAGES", "epuck_firmware.hex");
    const auto rab = outside("PUCKLOOP_IMAGES", "randb.hex");
    const auto program = outside("PUCKLOOP_ARGOS", "argos_epuck");
    const auto experiment = outside("PUCKLOOP_ARGOS", "avoid_rab.argos");
    if (!pic || !rab || !program || !experiment) {
        WARN("PUCKLOOP_IMAGES has no epuck_firmware.hex and randb.hex, or PUCKLOOP_ARGOS no argos_epuck and "
             "avoid_rab.argos: skipped");
        return;
    }
    const Workbench bench;
    const Words words{"run",          kScenarios + "own_rab.toml",
                      "--out",        bench.out("o"),
                      "--firmware",   "pic=" + pic->string(),
                      "--firmware",   "rab=" + rab->string(),
                      "--duration",   "47",
                      "--in-process", "--linux",
                      *program,       "-c",
                      *experiment,    "-i",
                      "avoid"};
    const Ended ended = bench.start(words)->wait(600);
    INFO(ended.err);
    REQUIRE(ended.status == 0);
    const auto losses = losses_of(bench, "o", {"--from", "43"});
    const auto& all = losses["groups"][0];
    CHECK(all["frames"] > 300);
    // The sheet measured 5 to 50 % for two such boards at 100 kHz; the published model has 70 %.
    CHECK(all["share"] > 0.02);
    CHECK(all["share"] < 0.75);
    const auto& lost = all["lost_by_cause"];
    const int bus = lost["receiver_i2c"].get<int>() + lost["sender_i2c"].get<int>();
    CHECK(bus > 9 * (all["frames"].get<int>() - all["delivered"].get<int>()) / 10);
    for (const char* robot : {"robot0", "robot1"}) {
        CHECK(losses["boards"][robot]["poll_period_s"] == Approx(0.023).margin(0.003));
        CHECK(losses["boards"][robot]["unexplained_messages"] <= 2);
    }
}
