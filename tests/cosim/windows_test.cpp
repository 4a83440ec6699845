// Nodes of one process in windows (cosim/schedule/windows.h): as bounds.h has it, and the same trace.

#include "cosim/schedule/windows.h"

#include "base/random.h"
#include "toy_run.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <optional>
#include <utility>

namespace puckloop::cosim {
namespace {

using toy::Recorder;
using toy::Run;

/// A time from a few nanoseconds to some milliseconds, or never.
Time drawn(RandomStream& random, unsigned nevers) {
    if (random.below(nevers) == 0) return kNever;
    return static_cast<Time>(random.below(std::uint64_t{1} << (10 + random.below(24))));
}

std::vector<Channel> drawn_channels(RandomStream& random, std::size_t nodes) {
    std::vector<Channel> channels;
    for (std::size_t c = 0, count = random.below(3 * nodes); c < count; ++c) {
        const auto from = static_cast<std::size_t>(random.below(nodes));
        const auto to = static_cast<std::size_t>(random.below(nodes));
        if (from != to) channels.push_back({from, to, drawn(random, 5), drawn(random, 5)});
    }
    return channels;
}

}  // namespace

TEST_CASE("windows have the limits of bounds") {
    for (std::uint64_t seed = 1; seed <= 2000; ++seed) {
        INFO("seed " << seed);
        RandomStream random(seed, "windows");
        const auto count = static_cast<std::size_t>(2 + random.below(12));
        std::vector<Channel> channels = drawn_channels(random, count);
        Windows windows;
        windows.connect(channels, std::vector<Windows::Sampling>(channels.size()), count);
        for (int turn = 0; turn < 3; ++turn) {
            if (!channels.empty()) {
                Channel& changed = channels[random.below(channels.size())];
                changed.base = drawn(random, 5);
                changed.lookahead = drawn(random, 5);
                windows.update(changed.from, channels);
            }
            std::vector<Time> pending;
            for (std::size_t n = 0; n < count; ++n)
                pending.push_back(drawn(random, 3));
            const std::vector<NodeTimes> nodes(count);
            Bounds bounds;
            bounds.compute(channels, pending);
            windows.plan(pending, pending, nodes, {kSecond, kNever, 10 * kMillisecond});
            REQUIRE(windows.floor() == bounds.floor());
            bool any = false;
            for (std::size_t n = 0; n < count; ++n) {
                REQUIRE(windows.limit(n) == bounds.limit(n));
                any = any || bounds.limit(n) > 0;
            }
            REQUIRE(windows.chosen().empty() == !any);
            for (const Windows::Step& step : windows.chosen())
                REQUIRE(step.until <= std::min<Time>(bounds.limit(step.node), 10 * kMillisecond));
        }
    }
}

TEST_CASE("what a node only looks at does not limit it before it looks") {
    // 0 -> 1 is looked at, 2 -> 1 is not; 1 -> 0 is there so that 1 matters to somebody.
    const std::vector<Channel> channels{{0, 1, 100, kNever}, {2, 1, 500, kNever}, {1, 0, 0, 20}};
    Windows windows;
    windows.connect(channels, {{.sampled = true}, {}, {}}, 3);
    std::vector<NodeTimes> nodes(3);
    const std::vector<Time> none(3, kNever);
    const auto step_of = [&](std::size_t node) -> std::optional<Windows::Step> {
        windows.plan(none, none, nodes, {kSecond, kNever, 10 * kMillisecond});
        for (const Windows::Step& step : windows.chosen())
            if (step.node == node) return step;
        return std::nullopt;
    };
    const auto first = step_of(1);
    REQUIRE(first);
    CHECK(first->until == 500);
    CHECK(first->known == 100);

    nodes[1].granted = 300;  // beyond what is known, and now it has to look
    windows.note_look(1, true);
    CHECK_FALSE(step_of(1));
    windows.note_look(1, false);  // or not yet
    CHECK(step_of(1));
    windows.note_look(1, true);
    std::vector<Channel> later = channels;
    later[0].base = 301;
    windows.update(0, later);
    CHECK(step_of(1));
    // It reaches nobody before where it is, whatever it looks at.
    later[2].base = 300;
    windows.update(1, later);
    step_of(1);
    CHECK(windows.limit(0) == 300);
}

TEST_CASE("what answers a node does not limit it while it has the turn") {
    const std::vector<Channel> channels{{0, 1, 100, 90}, {1, 0, 0, 0}};
    Windows windows;
    windows.connect(channels, {{.turns = true}, {}}, 2);
    const std::vector<NodeTimes> nodes(2);
    const std::vector<Time> none(2, kNever);
    const ScheduleLimits limits{kSecond, kNever, 10 * kMillisecond};
    windows.plan(none, none, nodes, limits);
    CHECK(windows.limit(1) == 90);
    CHECK(windows.answered(1) == kNever);
    windows.note_turn(1, true);
    windows.plan(none, none, nodes, limits);
    CHECK(windows.limit(1) == kNever);
    CHECK(windows.answered(1) == 90);
    CHECK(windows.limit(0) == 0);
}

TEST_CASE("what a node looks at does not bring forward what does not depend on it") {
    // 0 -> 1 is looked at; 1 -> 2 does not depend on it, 1 -> 3 does.
    const std::vector<Channel> channels{{0, 1, 100, kNever}, {1, 2, kNever, 20}, {1, 3, kNever, 20}};
    Windows windows;
    windows.connect(channels, {{.sampled = true}, {.independent = true}, {}}, 4);
    const std::vector<NodeTimes> nodes(4);
    const ScheduleLimits limits{kSecond, kNever, 10 * kMillisecond};
    std::vector<Time> pending(4, kNever), acting = pending;
    pending[1] = 60;  // light
    windows.plan(pending, acting, nodes, limits);
    CHECK(windows.limit(2) == kNever);
    CHECK(windows.limit(3) == 80);
    acting[1] = 70;
    windows.plan(pending, acting, nodes, limits);
    CHECK(windows.limit(2) == 90);
}

TEST_CASE("the trace in windows is the one of nodes that run ahead") {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Run run = toy::random_chatter(seed, 2 + static_cast<int>(seed));
        for (NodeSpec& node : run.nodes)
            node.any_thread = node.name.back() % 2 != 0 || seed % 2 == 0;  // helpers get some
        for (const LinkSpec& link : run.links)
            if (link.nominal_baud > 0 && (seed + run.faults.size()) % 2 == 0) {
                run.faults.push_back({link.name, "", seed % 3 == 0 ? "drop" : "duplicate", 0.2});
                run.faults.back().may_not_fire = true;
            }
        Recorder ahead;
        const Outcome before = run(&ahead);
        INFO("seed " << seed << ": " << before.text);
        REQUIRE(before.reason == EndReason::Duration);
        REQUIRE(!ahead.records.empty());
        run.options.windows = true;
        for (const unsigned threads : {1U, 2U, 4U})
            for (const std::uint64_t chop : {std::uint64_t{0}, seed}) {
                run.options.threads = threads;
                run.options.chop_seed.reset();
                if (chop != 0) run.options.chop_seed = chop;
                Recorder windows;
                const Outcome outcome = run(&windows);
                INFO("threads " << threads << " chop " << chop << ": " << outcome.text);
                REQUIRE(outcome.trace_sha256 == before.trace_sha256);
                REQUIRE(outcome.simulated == before.simulated);
                REQUIRE(windows.records == ahead.records);
            }
    }
}

TEST_CASE("a node of a process of its own takes a run out of windows") {
    Run run = toy::random_chatter(5, 4);
    const Outcome here = run();
    run.options.windows = true;
    run.nodes[1].in_process = false;
    CHECK(run().trace_sha256 == here.trace_sha256);
}

TEST_CASE("in windows a fault of a node is reported as without") {
    for (const auto& [line, cause] :
         {std::pair("thrower at_us=700", "thrown on purpose"),
          std::pair("liar at_us=700", "sent before its earliest output time on port uart0"),
          std::pair("turncoat at_us=700", "sent before its earliest output time on port uart0")}) {
        Run run{{{"honest", "idle"}, {"forger", line}},
                {toy::uart("wire", {"honest", "uart0"}, {"forger", "uart0"})}};
        run.nodes[1].any_thread = true;
        run.options.duration = 40 * kMillisecond;
        run.options.windows = true;
        for (const unsigned threads : {1U, 2U}) {
            run.options.in_process = true;
            run.options.threads = threads;
            const Outcome outcome = run();
            INFO(line);
            CHECK(outcome.reason == EndReason::Failed);
            CHECK(outcome.node == "forger");
            CHECK_THAT(outcome.text, Catch::Contains(cause));
        }
    }
}

TEST_CASE("in windows a cycle without look-ahead is reported with its nodes") {
    Run run{{{"idle", "idle"}, {"one", "mutual uarts=0 signals=2"}, {"two", "mutual uarts=0 signals=2"}},
            {{"a", {"one", "signals0"}, {"two", "signals1"}}}};
    run.options.duration = kSecond;
    run.options.in_process = run.options.windows = true;
    CHECK_THAT(run().text, Catch::Contains("deadlock") && Catch::Contains("one <- two <- one"));
    run.links[0].latency = kMillisecond;
    CHECK(run().reason == EndReason::Duration);
}

TEST_CASE("a run in windows ends with its nodes, and at a stop") {
    Run run = toy::random_chatter(3, 4);
    run.nodes.push_back({"late", "stopper at_us=3000"});
    const Outcome before = run();
    REQUIRE(before.reason == EndReason::NodeStopped);
    run.options.windows = true;
    const Outcome outcome = run();
    CHECK(outcome.reason == EndReason::NodeStopped);
    CHECK(outcome.text == before.text);
    CHECK(outcome.trace_sha256 == before.trace_sha256);
}

}  // namespace puckloop::cosim
