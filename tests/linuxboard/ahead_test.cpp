// What the preloaded library answers by itself is what the node would have answered: programs that call in an
// order drawn from a seed print and send the same with and without, however time is granted.

#include "base/random.h"
#include "tests/linuxboard/bench.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <csignal>
#include <sstream>

using namespace puckloop;
using namespace puckloop::cosim;
using namespace puckloop::tests;

namespace {

struct Case {
    int seed = 0;
    const char* kind = "alone";
    bool i2c = false;
    bool signals = false;
    bool hang_up = false;
};

struct Ran {
    std::string log, trace, reason;
    std::uint64_t requests = 0;
};

Ran run(const Case& with, bool ask_always, Time slice, bool makes_up = false) {
    std::vector<std::string> args{std::to_string(with.seed), "150", with.kind};
    if (with.i2c) args.emplace_back("i2c");
    linuxboard::LinuxSpec spec = spec_for("jumble", args);
    spec.ask_always = ask_always;
    RandomStream random(static_cast<std::uint64_t>(with.seed), "jumble");
    if (with.signals) {
        for (Time time = 0; time < 300 * kMillisecond;
             time += static_cast<Time>(random.below(9)) * kMillisecond)
            spec.signals.push_back({time += kMillisecond, SIGUSR1});
    }
    if (with.hang_up) spec.hangups = {static_cast<Time>(random.below(60)) * kMillisecond};
    Bench bench(std::move(spec), slice);
    if (makes_up) bench.make_up(static_cast<std::uint64_t>(with.seed));
    bench.add_device(0x60, {{0, 1}, {1, 2}, {2, 3}, {3, 4}, {4, 5}, {5, 6}});
    for (Time time = kMillisecond; time < kSecond;
         time += static_cast<Time>(random.below(5'000)) * kMicrosecond) {
        const bool ends_line = random.below(5) == 0;
        bench.send(time, ends_line ? '\n' : static_cast<std::uint8_t>('0' + random.below(10)));
        time += 87 * kMicrosecond;
    }
    bench.run(3 * kSecond);
    REQUIRE(bench.node().stop());
    // What was written still goes out: 4095 bytes at most.
    bench.run(bench.node().stop()->time + 400 * kMillisecond, true);
    return {bench.log(), bench.trace(), bench.node().stop()->reason, bench.node().requests()};
}

/// The first lines in which two texts differ, or nothing.
std::string difference(const std::string& a, const std::string& b) {
    std::istringstream left(a), right(b);
    std::string one, other;
    for (int number = 1;; ++number) {
        const bool more_left = static_cast<bool>(std::getline(left, one));
        const bool more_right = static_cast<bool>(std::getline(right, other));
        if (!more_left && !more_right) return {};
        if (!more_left || !more_right || one != other)
            return fmt::format("line {}: {} | {}", number, more_left ? one : "(end)",
                               more_right ? other : "(end)");
    }
}

/// Returns requests without and with answers by the library.
std::pair<std::uint64_t, std::uint64_t> check(const Case& with) {
    CAPTURE(with.seed, with.kind, with.i2c, with.signals, with.hang_up);
    const Ran asked = run(with, true, 70 * kMicrosecond);
    CHECK(asked.log.size() > 1000);
    std::uint64_t fewest = asked.requests;
    for (const Time slice : {70 * kMicrosecond, 13 * kMicrosecond, 3 * kMillisecond}) {
        if (with.i2c && slice > 70 * kMicrosecond) continue;  // devices answer between two grants
        CAPTURE(slice);
        // In short steps the node runs ahead now and then on what does not come, too.
        const Ran ran = run(with, false, slice, slice < 70 * kMicrosecond);
        CHECK(difference(asked.log, ran.log) == "");
        CHECK(difference(asked.trace, ran.trace) == "");
        CHECK(ran.reason == asked.reason);
        fewest = std::min(fewest, ran.requests);
    }
    return {asked.requests, fewest};
}

}  // namespace

TEST_CASE("the library's own answers are the node's") {
    std::uint64_t asked = 0, with_answers = 0;
    for (int seed = 1; seed <= 24; ++seed) {
        const char* const kinds[] = {"alone", "threads", "family"};
        const auto [plain, fewest] =
            check({seed, kinds[seed % 3], seed % 2 == 0, seed % 4 == 1, seed % 8 == 3});
        asked += plain;
        with_answers += fewest;
    }
    CHECK(with_answers < asked * 3 / 4);
}

TEST_CASE("sleeping and reading the clock within granted time ask nothing") {
    constexpr int kSleeps = 1000;
    const auto requests = [](bool ask_always) {
        auto spec = spec_for("beat", {std::to_string(kSleeps), "100"});
        spec.ask_always = ask_always;
        Bench bench(std::move(spec), 10 * kMillisecond);
        bench.run(kSecond);
        CHECK(bench.log() == "100001\n");
        return bench.node().requests();
    };
    CHECK(requests(true) > kSleeps);
    CHECK(requests(false) < kSleeps / 20);
}
