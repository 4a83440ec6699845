// The trace is written by helpers where there are any: the same records in the same order, and what a sink
// cannot take ends the run.

#include "base/error.h"
#include "toy_run.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <limits>
#include <thread>
#include <utility>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

/// Takes so many records, refuses one, and would take more: the trace must not go on behind a gap.
struct FullDisk : Recorder {
    std::size_t room = std::numeric_limits<std::size_t>::max();
    std::thread::id own = std::this_thread::get_id();
    bool full = false;
    std::size_t beside = 0;  ///< records that came from another thread

    void record(const TraceRecord& record) override {
        if (records.size() == room && !std::exchange(full, true)) throw RunError("the disk is full");
        if (std::this_thread::get_id() != own) ++beside;
        Recorder::record(record);
    }
};

Run long_run(std::uint64_t seed, unsigned threads, bool windows = false) {
    Run run = toy::random_chatter(seed, 6);
    run.options.duration = 150 * kMillisecond;
    run.options.threads = threads;
    run.options.windows = windows;
    for (NodeSpec& node : run.nodes)
        node.any_thread = true;
    return run;
}

}  // namespace

TEST_CASE("helpers write the same trace") {
    std::size_t beside = 0;
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
        FullDisk alone;
        const Outcome expected = long_run(seed, 1)(&alone);
        REQUIRE(expected.reason == EndReason::Duration);
        CHECK(alone.beside == 0);
        for (const auto& [threads, windows] :
             {std::pair(2u, false), std::pair(4u, false), std::pair(2u, true), std::pair(4u, true)}) {
            FullDisk recorder;
            const Outcome outcome = long_run(seed, threads, windows)(&recorder);
            CHECK(outcome.trace_sha256 == expected.trace_sha256);
            REQUIRE((recorder.records == alone.records));
            beside += recorder.beside;
        }
    }
    CHECK(beside > 0);
}

TEST_CASE("in windows helpers write all along, with nodes for them or without") {
    for (const bool any_thread : {false, true}) {
        double most = 0.0;  // a loaded machine may give a helper no core for the length of a run
        for (int tries = 0; tries < 20 && most <= 0.5; ++tries) {
            Run run = long_run(3, 2, true);
            for (NodeSpec& node : run.nodes)
                node.any_thread = any_thread;
            FullDisk recorder;
            run(&recorder);
            REQUIRE(recorder.records.size() > 2000);
            const auto all = static_cast<double>(recorder.records.size());
            most = std::max(most, static_cast<double>(recorder.beside) / all);
        }
        CHECK(most > 0.5);
    }
}

TEST_CASE("what a sink cannot take ends the run, whichever thread it is") {
    FullDisk all;
    long_run(3, 1)(&all);
    REQUIRE(all.records.size() > 2000);
    for (const auto& [threads, windows] : {std::pair(1u, false), std::pair(2u, false), std::pair(4u, false),
                                           std::pair(1u, true), std::pair(2u, true), std::pair(4u, true)})
        for (const std::size_t room : {std::size_t{0}, std::size_t{700}, all.records.size() - 1}) {
            FullDisk disk;
            disk.room = room;
            const Outcome outcome = long_run(3, threads, windows)(&disk);
            INFO(threads << " threads, room for " << room << ": " << outcome.text);
            CHECK(outcome.reason == EndReason::Failed);
            CHECK(outcome.text == "the disk is full");
            CHECK(outcome.node.empty());
            REQUIRE(disk.records.size() == room);
            CHECK(std::equal(disk.records.begin(), disk.records.end(), all.records.begin()));
        }
}
