// Runs of small nodes, saved at drawn instants and gone on with: nothing distinguishes them from the whole
// run.

#include "base/random.h"
#include "cosim/resume/run_snapshot.h"
#include "cosim/resume/state_file.h"
#include "tests/cosim/toy_run.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

FaultSpec fault(const std::string& link, const std::string& kind, double probability, Time begin = 0) {
    FaultSpec spec;
    spec.link = link;
    spec.kind = kind;
    spec.probability = probability;
    spec.begin = begin;
    return spec;
}

/// Snapshots of `run` at `times`, through a file's bytes.
std::vector<RunSnapshot> saved(Run run, std::vector<Time> times, Outcome& outcome) {
    std::vector<RunSnapshot> snapshots;
    std::sort(times.begin(), times.end());
    run.options.save_at = times;
    run.options.save = [&](RunSnapshot& snapshot) {
        snapshot.build = build_id();
        snapshots.push_back(decode_snapshot(encode(snapshot), "x.snap"));
    };
    outcome = run();
    return snapshots;
}

/// Runs on from `from`; checks that it is `whole`, whose records `all` are.
void check_goes_on(Run run, const RunSnapshot& from, const Outcome& whole,
                   const std::vector<TraceRecord>& all) {
    INFO("from " << from.time);
    run.options.from = &from;
    Recorder recorder;
    const Outcome outcome = run(&recorder);
    INFO(outcome.text);
    CHECK(outcome.reason == whole.reason);
    CHECK(outcome.text == whole.text);
    CHECK(outcome.simulated == whole.simulated);
    CHECK(outcome.trace_sha256 == whole.trace_sha256);
    const auto first = std::find_if(all.begin(), all.end(),
                                    [&](const TraceRecord& record) { return record.time >= from.time; });
    const bool same = std::equal(first, all.end(), recorder.records.begin(), recorder.records.end());
    CHECK(same);
    for (std::size_t n = 0; n < whole.nodes.size(); ++n)
        CHECK(outcome.nodes[n].json == whole.nodes[n].json);
    for (std::size_t l = 0; l < whole.links.size(); ++l) {
        CHECK(outcome.links[l].from_a == whole.links[l].from_a);
        CHECK(outcome.links[l].from_b == whole.links[l].from_b);
    }
    REQUIRE(outcome.faults.size() == whole.faults.size());
    for (std::size_t f = 0; f < whole.faults.size(); ++f) {
        CHECK(outcome.faults[f].fired == whole.faults[f].fired);
        CHECK((outcome.faults[f].firings == whole.faults[f].firings));
    }
}

}  // namespace

TEST_CASE("a run goes on from drawn instants as if it had never stopped") {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        INFO("seed " << seed);
        Run run = toy::random_chatter(seed, 2 + static_cast<int>(seed % 5));
        RandomStream random(seed, "instants");
        for (const LinkSpec& link : run.links) {
            if (link.nominal_baud == 0) continue;
            for (const char* kind : {"drop", "swap", "delay", "duplicate", "insert", "baud"})
                if (random.below(2) == 0) {
                    run.faults.push_back(fault(link.name, kind, 0.2));
                    run.faults.back().may_not_fire = true;
                    if (kind == std::string("baud")) run.faults.back().set("offset", 0.02);
                    if (kind == std::string("delay")) run.faults.back().set("delay", 3e-4);
                }
        }
        if (seed % 3 == 0)
            run.nodes.push_back({"late", fmt::format("stopper at_us={}", 500 + random.below(19000))});
        Recorder all;
        const Outcome whole = run(&all);
        INFO(whole.text);
        REQUIRE(whole.reason != EndReason::Failed);
        std::vector<Time> times;
        for (int i = 0; i < 4; ++i)
            times.push_back(1 + static_cast<Time>(random.below(static_cast<std::uint64_t>(whole.simulated))));
        Run saving = run;
        saving.options.chop_seed = seed;  // snapshots do not depend on how grants were cut
        saving.options.windows = seed % 2 == 0;
        Outcome outcome;
        const std::vector<RunSnapshot> snapshots = saved(saving, times, outcome);
        CHECK(outcome.trace_sha256 == whole.trace_sha256);
        REQUIRE(snapshots.size() == times.size());
        for (std::size_t i = 0; i < snapshots.size(); ++i) {
            Run again = run;
            again.options.in_process = i != 0 || seed % 4 != 0;  // processes are slow to start
            again.options.threads = i % 2 == 0 ? 1 : 2;
            again.options.windows = (seed + i) % 3 == 0;
            check_goes_on(again, snapshots[i], whole, all.records);
        }
        // Saved again by a run that went on.
        Run second = run;
        second.options.from = &snapshots.front();
        if (snapshots.front().time < snapshots.back().time) {
            const auto later = saved(second, {snapshots.back().time}, outcome);
            REQUIRE(later.size() == 1);
            const bool same = encode(later[0]) == encode(snapshots.back());
            CHECK(same);
        }
    }
}

TEST_CASE("a fault that begins later acts as in a whole run, one that acts earlier is refused") {
    int refused = 0, accepted = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
        INFO("seed " << seed);
        Run run = toy::random_chatter(seed, 3);
        const auto wire = std::find_if(run.links.begin(), run.links.end(),
                                       [](const LinkSpec& link) { return link.nominal_baud > 0; });
        if (wire == run.links.end()) continue;
        RandomStream random(seed, "fault");
        Outcome plain;
        const Time at = 5 * kMillisecond + static_cast<Time>(random.below(10)) * kMillisecond + 1;
        const auto snapshots = saved(run, {at}, plain);
        REQUIRE(snapshots.size() == 1);
        // Counts what matches from the beginning; its window may begin before the snapshot.
        constexpr std::array kKinds{"drop", "flip", "break", "swap", "false_start", "loopback"};
        Run other = run;
        other.faults.push_back(fault(wire->name, kKinds[random.below(kKinds.size())], 1.0,
                                     at + (static_cast<Time>(random.below(8)) - 2) * kMillisecond));
        if (other.faults.back().kind == "false_start") other.faults.back().set("width", 2e-6);
        other.faults.back().skip = random.below(3);
        other.faults.back().end = other.faults.back().begin + 3 * kMillisecond;
        other.faults.back().may_not_fire = true;
        INFO(other.faults.back().kind << " at " << other.faults.back().begin << ", saved at " << at);
        Recorder all;
        const Outcome whole = other(&all);
        INFO(whole.text);
        REQUIRE(whole.reason != EndReason::Failed);
        Recorder now;
        Run before = run;
        before(&now);
        // A fault's own messages have numbers too, which moves those of the others.
        const auto same = [](const TraceRecord& x, const TraceRecord& y) {
            return x.time == y.time && x.link == y.link && x.direction == y.direction && x.fault == y.fault &&
                   x.payload == y.payload;
        };
        const auto differs = std::mismatch(all.records.begin(), all.records.end(), now.records.begin(),
                                           now.records.end(), same);
        const Time first = std::min(differs.first == all.records.end() ? kNever : differs.first->time,
                                    differs.second == now.records.end() ? kNever : differs.second->time);
        if (first >= at) {
            check_goes_on(other, snapshots[0], whole, all.records);
            ++accepted;
        } else {
            other.options.from = snapshots.data();
            const Outcome outcome = other();
            CHECK(outcome.reason == EndReason::Failed);
            CHECK_THAT(outcome.text,
                       Catch::Contains(wire->name + ", fault 1") && Catch::Contains("before the snapshot"));
            ++refused;
        }
    }
    CHECK(accepted > 5);
    CHECK(refused > 2);
}

TEST_CASE("a node that does something else when it is executed again is named") {
    Run run = toy::random_chatter(3, 3);
    Outcome outcome;
    const auto snapshots = saved(run, {10 * kMillisecond}, outcome);
    REQUIRE(snapshots.size() == 1);
    Run other = run;
    // Another seed: another node, under the same name.
    const auto place = other.nodes[1].json.find("seed=") + 5;
    other.nodes[1].json.replace(place, 3, "999");
    other.options.from = snapshots.data();
    const Outcome unlike = other();
    CHECK(unlike.reason == EndReason::Failed);
    CHECK_THAT(unlike.text, Catch::Contains("n1: executed again it does not send what it sent"));
    // Unless it speaks for something that cannot be repeated: then what it said stands.
    other.nodes[1].outside = true;
    CHECK(other().reason == EndReason::Duration);
}

TEST_CASE("a run that ends before has no snapshot") {
    Run run = toy::random_chatter(5, 3);
    run.nodes.push_back({"end", "stopper at_us=3000"});
    run.options.stop_latency = kMillisecond;
    Outcome outcome;
    CHECK(saved(run, {2 * kMillisecond, 3500 * kMicrosecond, 15 * kMillisecond}, outcome).size() == 2);
    CHECK(outcome.simulated < 5 * kMillisecond);
}
