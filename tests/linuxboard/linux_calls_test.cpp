// What calls on devices answer (docs/linux-calls.md), by programs that compare; and calls at random.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <cstdlib>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;
using Catch::Contains;
using Catch::EndsWith;

namespace {
std::string answers(const std::string& device) {
    Bench bench(spec_for("answers", {device}));
    std::map<std::uint8_t, std::uint8_t> registers;
    for (unsigned i = 0; i < 256; ++i)
        registers[static_cast<std::uint8_t>(i)] = static_cast<std::uint8_t>(0x10 + i);
    bench.add_device(0x60, registers);
    bench.run(10 * kSecond);
    REQUIRE(bench.node().stop());
    return bench.log() + (bench.node().stop()->success ? "" : bench.node().stop()->reason);
}
}  // namespace

TEST_CASE("what is expected of any terminal is what this host's kernel does on a pty") {
    const int status = std::system((program("answers") + " pty > /dev/null").c_str());
    if (WEXITSTATUS(status) == 77) {
        WARN("there is no pty: skipped");
        return;
    }
    CHECK(WEXITSTATUS(status) == 0);
}

TEST_CASE("calls on a device answer as Linux's drivers do") {
    const std::string device = GENERATE(values<std::string>({"serial", "i2c", "clocks"}));
    CAPTURE(device);
    CHECK_THAT(answers(device), EndsWith(" checked, 0 wrong\n"));
}

TEST_CASE("calls drawn at random end with an answer") {
    for (int seed = 1; seed <= 3; ++seed) {
        Bench bench(spec_for("drawn_calls", {std::to_string(seed), "1000"}));
        bench.add_device(0x60, {{0, 1}, {1, 2}});
        bench.send(10 * kMillisecond, std::string(200, 'x'));
        bench.run(100'000 * kSecond);
        CAPTURE(seed);
        REQUIRE(bench.node().stop());
        CHECK(bench.node().stop()->success);
        INFO(bench.node().stop()->reason);
        CHECK_THAT(bench.log(), EndsWith("1000 calls, 0 wrong\n"));
    }
}

TEST_CASE("many calls drawn at random end with an answer", "[.sweep]") {
    const char* set = std::getenv("PUCKLOOP_SEEDS");
    const int seeds = set != nullptr ? std::atoi(set) : 10;
    for (int seed = 100; seed < 100 + seeds; ++seed) {
        Bench bench(spec_for("drawn_calls", {std::to_string(seed), "10000"}));
        bench.add_device(0x60, {{0, 1}, {1, 2}});
        bench.run(100'000 * kSecond);
        CAPTURE(seed);
        REQUIRE(bench.node().stop());
        INFO(bench.node().stop()->reason);
        CHECK_THAT(bench.log(), EndsWith("10000 calls, 0 wrong\n"));
    }
}
