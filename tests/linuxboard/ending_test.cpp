// Programs that are asked to end: by a signal of the scenario, or because the run ends.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <csignal>
#include <filesystem>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;

namespace {

constexpr Time kEnd = 200 * kMillisecond;
constexpr Time kGrace = 100 * kMillisecond;

/// A program of its kind that is asked to end at kEnd, and what became of it.
struct Asked {
    Bench bench;
    std::string report;

    explicit Asked(const std::string& how, int signal = 0, int scenario_signal = SIGTERM,
                   Time slice = 70 * kMicrosecond)
        : bench(spec(how, scenario_signal), slice) {
        bench.run(kEnd);
        bench.node().wind_up(kEnd, signal);
        if (bench.node().wound_up() == kNever) bench.run(kEnd + kSecond);
        report = bench.node().finish();
    }
    static linuxboard::LinuxSpec spec(const std::string& how, int signal) {
        linuxboard::LinuxSpec spec = spec_for("polite", {how});
        spec.end_signal = signal;
        spec.grace = kGrace;
        return spec;
    }
};

}  // namespace

TEST_CASE(
    "a program that is asked to end runs its handler, sends a last record to the robot and saves its files") {
    Asked asked("handler");
    CHECK(asked.bench.log() ==
          "read -1, Interrupted system call, signal 15\nasked by 15 at 200 ms\nsaved at 200 ms\n");
    CHECK(asked.bench.sent() == "R");
    CHECK(asked.bench.node().wound_up() == Approx(kEnd).margin(kMillisecond));
    CHECK(!asked.bench.node().stop());
    CHECK_THAT(asked.report, Contains("exited with status 0 after SIGTERM at the end of the run"));
}

TEST_CASE("the user's signal goes before the scenario's") {
    CHECK_THAT(Asked("handler", SIGINT).bench.log(), Contains("asked by 2 at 200 ms"));
    CHECK_THAT(Asked("handler", 0, SIGINT).bench.log(), Contains("asked by 2 at 200 ms"));
}

TEST_CASE("the end does not depend on how time is granted") {
    Asked fine("threads", 0, SIGTERM, 11 * kMicrosecond), coarse("threads");
    CHECK(fine.bench.trace() == coarse.bench.trace());
    CHECK(fine.bench.log() == coarse.bench.log());
    CHECK(!fine.bench.trace().empty());
}

TEST_CASE("a handler runs while the main thread waits for another one, sigwait takes a blocked signal") {
    const std::string how = GENERATE("threads", "sigwait");
    Asked asked(how);
    CHECK_THAT(asked.bench.log(), Contains("asked by 15 at 20") && Contains("saved at 20"));
    CHECK(asked.bench.sent() == "R");
}

TEST_CASE("a program that does not end is killed after the grace period") {
    const std::string how = GENERATE("restart", "deaf");
    Asked asked(how);
    CHECK(asked.bench.log().empty());
    CHECK(asked.bench.node().wound_up() == kEnd + kGrace);
    CHECK_THAT(asked.report, Contains("was killed: it had not ended 0.1 s after SIGTERM"));
}

TEST_CASE("a program without a handler ends with the run at once") {
    Asked asked("plain");
    CHECK(asked.bench.node().wound_up() == 0);
    CHECK_THAT(asked.report, Contains("was ended with the run"));
}

TEST_CASE("a crash on the way out fails the run, another status is a warning") {
    Asked crash("crash");
    REQUIRE(crash.bench.node().stop());
    CHECK(!crash.bench.node().stop()->success);
    CHECK_THAT(crash.bench.node().stop()->reason,
               Contains("SIGSEGV") && Contains("after SIGTERM at the end of the run"));
    Asked fail("fail");
    CHECK(!fail.bench.node().stop());
    CHECK_THAT(fail.report, Contains("exited with status 9 after SIGTERM"));
    CHECK(fail.bench.node().warnings().size() == 1);
}
