#include "toy_run.h"

#include "base/error.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <atomic>
#include <set>
#include <thread>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

Run ping_pong(bool in_process) {
    Run run{{{"left", "echo first=1"}, {"right", "echo delay_us=100"}},
            {toy::uart("wire", {"left", "uart0"}, {"right", "uart0"})}};
    run.options.duration = 10 * kMillisecond;
    run.options.in_process = in_process;
    return run;
}

void check_same(const Outcome& a, const Outcome& b) {
    CHECK(a.trace_sha256 == b.trace_sha256);
    CHECK(a.text == b.text);
    CHECK(a.simulated == b.simulated);
    REQUIRE(a.nodes.size() == b.nodes.size());
    for (std::size_t n = 0; n < a.nodes.size(); ++n)
        CHECK(a.nodes[n].json == b.nodes[n].json);
    for (std::size_t l = 0; l < a.links.size(); ++l) {
        CHECK(a.links[l].from_a == b.links[l].from_a);
        CHECK(a.links[l].from_b == b.links[l].from_b);
    }
}

}  // namespace

TEST_CASE("two nodes exchange bytes with the times of the line") {
    Recorder recorder;
    const Outcome outcome = ping_pong(true)(&recorder);
    CHECK(outcome.reason == EndReason::Duration);
    CHECK(outcome.simulated == 10 * kMillisecond);
    REQUIRE(recorder.records.size() > 10);
    const Time flight = 9 * kSecond / 115200;
    // The toy's bit time is rounded down to a picosecond: the link's nine bits are the later ones.
    CHECK(recorder.records[0].time == kMicrosecond + flight);
    CHECK(recorder.records[1].time == kMicrosecond + 2 * flight + 100 * kMicrosecond);
    CHECK(recorder.records[2].time == kMicrosecond + 3 * flight + 110 * kMicrosecond);
    for (std::size_t i = 0; i < recorder.records.size(); ++i) {
        CHECK(std::get<UartFrame>(recorder.records[i].payload).data == (i & 0xff));
        CHECK(recorder.records[i].direction == (i % 2 == 0 ? Direction::FromA : Direction::FromB));
    }
    CHECK(outcome.links[0].from_a.uart_frames + outcome.links[0].from_b.uart_frames ==
          recorder.records.size());
    CHECK(recorder.flushed);
}

TEST_CASE("a frame faster than nominal arrives no earlier than nine nominal bits after its start") {
    Run run = ping_pong(true);
    run.links[0].nominal_baud = 9600.0;
    Recorder recorder;
    run(&recorder);
    const Time flight = 9 * kSecond / 9600;
    REQUIRE(recorder.records.size() > 2);
    CHECK(recorder.records[0].time == kMicrosecond + flight);
    for (const TraceRecord& record : recorder.records)
        CHECK(record.time == std::get<UartFrame>(record.payload).start + flight);
}

TEST_CASE("the trace is ordered, and the same for every cutting of grants") {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
        Run run = toy::random_chatter(seed, 2 + static_cast<int>(seed % 6));
        Recorder recorder;
        const Outcome whole = run(&recorder);
        INFO(whole.text);
        REQUIRE(whole.reason == EndReason::Duration);
        REQUIRE(recorder.records.size() > 50);
        for (std::size_t i = 1; i < recorder.records.size(); ++i)
            REQUIRE(recorder.records[i - 1].key() < recorder.records[i].key());
        for (std::uint64_t chop = 1; chop <= 3; ++chop) {
            run.options.chop_seed = chop;
            Recorder chopped;
            const Outcome cut = run(&chopped);
            INFO("seed " << seed << " chop " << chop << ": " << cut.text);
            REQUIRE(cut.grants > whole.grants);
            check_same(whole, cut);
            REQUIRE(chopped.records == recorder.records);
        }
    }
}

TEST_CASE("the trace is the same for every placement") {
    check_same(ping_pong(true)(), ping_pong(false)());
    for (std::uint64_t seed = 1; seed <= 4; ++seed) {
        Run run = toy::random_chatter(seed, 4);
        const Outcome here = run();
        REQUIRE(here.reason == EndReason::Duration);
        for (unsigned subset = 1; subset < 16; subset += seed == 1 ? 1 : 7) {
            for (std::size_t n = 0; n < 4; ++n)
                run.nodes[n].in_process = (subset >> n & 1) == 0;
            const Outcome there = run();
            INFO("seed " << seed << " subset " << subset << ": " << there.text);
            check_same(here, there);
        }
    }
}

TEST_CASE("a node that may speak at any time but does not is granted long stretches") {
    // "mutual" has no EOT beyond its own time and answers at once; its partner answers after a while.
    Run run{{{"board", "mutual"}, {"program", "echo delay_us=10"}},
            {toy::uart("wire", {"board", "uart0"}, {"program", "uart0"})}};
    run.options.duration = kSecond;
    run.options.in_process = true;
    const Outcome outcome = run();
    CHECK(outcome.reason == EndReason::Duration);
    // One grant each for every stop latency of 10 ms, not one for each 170 us that an echo takes.
    CHECK(outcome.grants < 1000);
}

TEST_CASE("ten runs under load are one run") {
    std::atomic<bool> over{false};
    std::vector<std::thread> burners;
    for (int i = 0; i < 2; ++i)
        burners.emplace_back([&over] {
            while (!over)
                ;
        });
    Run run = toy::random_chatter(8, 3);
    run.options.in_process = false;
    run.options.duration = 5 * kMillisecond;
    const Outcome first = run();
    for (int repeat = 1; repeat < 10; ++repeat)
        check_same(first, run());
    over = true;
    for (std::thread& burner : burners)
        burner.join();
}

TEST_CASE("paced by the wall clock a run takes its time, reports its progress, and is the same") {
    Run run = ping_pong(true);
    run.options.duration = 300 * kMillisecond;
    const Outcome free = run();
    CHECK(free.wall_s < 0.25);
    run.options.realtime = true;
    std::vector<Progress> told;
    run.options.progress = [&told](const Progress& progress) { told.push_back(progress); };
    const Outcome paced = run();
    CHECK(paced.wall_s >= 0.295);
    CHECK(paced.trace_sha256 == free.trace_sha256);
    REQUIRE(!told.empty());
    CHECK(told[0].time > 100 * kMillisecond);
    CHECK(told[0].wall_s >= 0.2);
    CHECK(told[0].factor > 0.3);
    CHECK(told[0].factor < 1.1);
}

TEST_CASE("another seed is another trace") {
    std::set<std::string> hashes;
    for (std::uint64_t seed = 1; seed <= 5; ++seed)
        hashes.insert(toy::random_chatter(seed, 3)().trace_sha256);
    CHECK(hashes.size() == 5);
}

TEST_CASE("a node's request to stop ends the run at the same time in every placement") {
    for (const int at_us : {1, 4000, 9999, 12345}) {
        Run run = toy::random_chatter(3, 4);
        run.nodes.push_back({"program", fmt::format("stopper at_us={} success=0", at_us)});
        run.nodes.push_back({"second", fmt::format("stopper at_us={}", at_us + 5000)});
        run.options.duration = 200 * kMillisecond;
        Recorder recorder;
        const Outcome here = run(&recorder);
        CHECK(here.reason == EndReason::NodeStopped);
        CHECK(here.node == "program");
        CHECK_FALSE(here.success);
        CHECK(here.stop_time == at_us * kMicrosecond);
        CHECK(here.simulated == at_us * kMicrosecond + run.options.stop_latency);
        CHECK(recorder.records.back().time < here.simulated);
        run.options.chop_seed = 9;
        check_same(here, run());
        run.options.chop_seed.reset();
        run.options.in_process = false;
        check_same(here, run());
    }
}

TEST_CASE("several threads leave the same trace as one, and name the node that fails") {
    for (const std::uint64_t seed : {1u, 2u, 3u}) {
        Run run = toy::random_chatter(seed, 6);
        const Outcome alone = run();
        for (NodeSpec& node : run.nodes)
            node.any_thread = node.name != "n0";
        for (const unsigned threads : {2u, 4u}) {
            run.options.threads = threads;
            check_same(alone, run());
        }
        run.nodes.push_back({"bad", "thrower at_us=1000", {}, true});
        const Outcome failed = run();
        CHECK(failed.reason == EndReason::Failed);
        CHECK(failed.node == "bad");
        CHECK_THAT(failed.text, Catch::Contains("thrown on purpose"));
    }
}

TEST_CASE("nodes that want to stop together end the run with the last of them") {
    const int one_us = GENERATE(1, 50'000), other_us = GENERATE(12'345, 49'999);
    Run run = toy::random_chatter(3, 4);
    run.nodes.push_back({"one", fmt::format("stopper at_us={} together=2", one_us)});
    run.nodes.push_back({"other", fmt::format("stopper at_us={} together=2", other_us)});
    run.options.duration = 200 * kMillisecond;
    const Outcome here = run();
    CHECK(here.reason == EndReason::NodeStopped);
    CHECK(here.node == (one_us > other_us ? "one" : "other"));
    CHECK(here.simulated == std::max(one_us, other_us) * kMicrosecond + run.options.stop_latency);
    run.options.in_process = false;
    check_same(here, run());
    run.nodes.back().json =
        fmt::format("stopper at_us={} success=0", other_us);  // one fails: that is the end
    const Outcome failed = run();
    CHECK(failed.node == "other");
    CHECK_FALSE(failed.success);
    run.nodes.pop_back();  // one of two for ever
    CHECK(run().reason == EndReason::Duration);
}

TEST_CASE("a cycle without look-ahead is reported with its nodes") {
    Run run{{{"idle", "idle"}, {"one", "mutual uarts=0 signals=2"}, {"two", "mutual uarts=0 signals=2"}},
            {{"a", {"one", "signals0"}, {"two", "signals1"}}}};
    run.options.duration = kSecond;
    run.options.in_process = true;
    const Outcome outcome = run();
    CHECK(outcome.reason == EndReason::Failed);
    CHECK_THAT(outcome.text, Catch::Contains("deadlock") && Catch::Contains("one <- two <- one"));
    CHECK_THAT(outcome.text, !Catch::Contains("idle"));
    // A latency on the link dissolves it.
    run.links[0].latency = kMillisecond;
    CHECK(run().reason == EndReason::Duration);
}

TEST_CASE("a node at the edge of a zero cycle does not spin, it is reported as deadlocked") {
    // The bus has something to say now, and the program would answer in no time.
    Run run{{{"bus", "chatter seed=1 uarts=0 signals=1 fly_us=0"}, {"program", "mutual uarts=0 signals=1"}},
            {{"wire", {"bus", "signals0"}, {"program", "signals0"}}}};
    run.options.duration = 10 * kMillisecond;
    for (const bool in_process : {true, false}) {
        run.options.in_process = in_process;
        CHECK_THAT(run().text,
                   Catch::Contains("deadlock") && Catch::Contains("bus") && Catch::Contains("program"));
    }
    run.links[0].latency = kNanosecond;
    CHECK(run().reason == EndReason::Duration);
}

TEST_CASE("a message before the EOT names the node, the port and the EOT") {
    Run run{{{"honest", "idle"}, {"forger", "liar at_us=700"}},
            {toy::uart("wire", {"honest", "uart0"}, {"forger", "uart0"})}};
    run.options.duration = 5 * kMillisecond;
    for (const bool in_process : {true, false}) {
        run.options.in_process = in_process;
        const Outcome outcome = run();
        CHECK(outcome.reason == EndReason::Failed);
        CHECK(outcome.node == "forger");
        CHECK_THAT(outcome.text,
                   Catch::Contains("node forger sent before its earliest output time on port uart0") &&
                       Catch::Contains("0.000700000000 s"));
    }
}

TEST_CASE("an EOT holds, even when the node reports an earlier one later") {
    // It states that it will be silent for ever, then that it may speak at any time, then speaks.
    Run run{{{"honest", "idle"}, {"turncoat", "turncoat at_us=700"}},
            {toy::uart("wire", {"honest", "uart0"}, {"turncoat", "uart0"})}};
    run.options.duration = 40 * kMillisecond;
    run.options.in_process = true;
    for (std::uint64_t chop = 1; chop <= 3; ++chop) {
        run.options.chop_seed = chop;
        const Outcome outcome = run();
        CHECK(outcome.reason == EndReason::Failed);
        CHECK_THAT(outcome.text,
                   Catch::Contains("node turncoat sent before its earliest output time on port uart0"));
    }
}

TEST_CASE("what does not fit together is refused before the run") {
    const Run good = ping_pong(true);
    Run run = good;
    run.links[0].b.node = "nobody";
    CHECK_THROWS_AS(run(), InputError);
    run = good;
    run.links[0].b.port = "uart7";
    CHECK_THROWS_WITH(run(), Catch::Contains("node right has no port \"uart7\"") && Catch::Contains("uart0"));
    run = good;
    run.links[0].nominal_baud = 0;
    CHECK_THROWS_WITH(run(), Catch::Contains("no nominal baud"));
    run = good;
    run.links.push_back(run.links[0]);
    CHECK_THROWS_WITH(run(), Catch::Contains("linked already"));
    run = good;
    run.nodes[1].name = "left";
    CHECK_THROWS_WITH(run(), Catch::Contains("two nodes"));
    for (const bool in_process : {true, false}) {
        run = ping_pong(in_process);
        run.nodes[1].json = "refuser";
        CHECK_THROWS_AS(run(), InputError);
        CHECK_THROWS_WITH(run(), "toy.hex: line 7: damaged on purpose");
    }
}
