// What calls on devices answer (docs/linux-calls.md), by programs that compare; and calls at random.

#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::linuxboard;
using namespace puckloop::tests;
using Catch::Contains;
using Catch::EndsWith;

namespace {
/// With a camera, whose pictures are black.
LinuxSpec spec_with_camera(const std::string& name, std::vector<std::string> args) {
    LinuxSpec spec = spec_for(name, std::move(args));
    spec.cameras.push_back({"/dev/video1", "test camera", {}, {}, 1});
    return spec;
}

struct Dark : Scenery {
    void change(std::uint16_t, double) override {}
    void render(std::size_t, const PictureSettings&, cosim::Time, std::uint64_t,
                std::span<std::uint8_t> rgb) override {
        std::fill(rgb.begin(), rgb.end(), std::uint8_t{0});
    }
};

std::string answers(const std::string& device) {
    Bench bench(spec_with_camera("answers", {device}), 70 * kMicrosecond, std::make_unique<Dark>());
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
    const std::string device = GENERATE(values<std::string>({"serial", "i2c", "clocks", "video"}));
    CAPTURE(device);
    CHECK_THAT(answers(device), EndsWith(" checked, 0 wrong\n"));
}

/// Of the i-th program: --rng-seed gives others.
static std::string drawn_seed(int i) {
    constexpr unsigned kApart = 1000, kMost = 1'000'000;
    return std::to_string(Catch::rngSeed() % kMost * kApart + static_cast<unsigned>(i));
}

TEST_CASE("calls drawn at random end with an answer") {
    for (int i = 1; i <= 3; ++i) {
        const std::string seed = drawn_seed(i);
        Bench bench(spec_with_camera("drawn_calls", {seed, "1000"}), 70 * kMicrosecond,
                    std::make_unique<Dark>());
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
    for (int i = 100; i < 100 + seeds; ++i) {
        const std::string seed = drawn_seed(i);
        Bench bench(spec_with_camera("drawn_calls", {seed, "10000"}), 70 * kMicrosecond,
                    std::make_unique<Dark>());
        bench.add_device(0x60, {{0, 1}, {1, 2}});
        bench.run(100'000 * kSecond);
        CAPTURE(seed);
        REQUIRE(bench.node().stop());
        INFO(bench.node().stop()->reason);
        CHECK_THAT(bench.log(), EndsWith("10000 calls, 0 wrong\n"));
    }
}
