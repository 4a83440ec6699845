// Which candidates suffer a fault, and the evidence of it.

#include "base/error.h"
#include "base/json.h"
#include "base/states/archive.h"
#include "cosim/faults/evidence.h"
#include "cosim/faults/fault_json.h"
#include "cosim/faults/trigger.h"

#include <catch2/catch.hpp>

#include <vector>

using namespace puckloop;
using namespace puckloop::cosim;

namespace {

std::vector<int> fired(const FaultSpec& spec, int candidates, std::uint64_t seed = 1) {
    Trigger trigger(spec, fault_stream(spec, seed, 0));
    std::vector<int> hits;
    for (int i = 0; i < candidates; ++i)
        if (trigger.fires(i * kMillisecond)) hits.push_back(i);
    return hits;
}

}  // namespace

TEST_CASE("skip, every and count pick the n-th candidates of the window") {
    RandomStream random(71, "trigger");
    for (int round = 0; round < 200; ++round) {
        FaultSpec spec;
        spec.skip = random.below(20);
        spec.every = 1 + random.below(9);
        spec.count = 1 + random.below(12);
        const auto from = static_cast<int>(random.below(50)),
                   until = from + 1 + static_cast<int>(random.below(100));
        spec.begin = from * kMillisecond;
        spec.end = until * kMillisecond;
        std::vector<int> expected;
        for (int i = from + static_cast<int>(spec.skip); i < until && expected.size() < spec.count;
             i += static_cast<int>(spec.every))
            expected.push_back(i);
        CHECK(fired(spec, 200) == expected);
    }
}

TEST_CASE("a burst has the lengths and the share of a Gilbert-Elliott channel") {
    FaultSpec spec;
    spec.burst = Burst{0.02, 0.25, 1.0, 0.0};
    constexpr int kMany = 200'000;
    const std::vector<int> hits = fired(spec, kMany);
    int bursts = 0;
    for (std::size_t i = 0; i < hits.size(); ++i)
        bursts += i == 0 || hits[i] != hits[i - 1] + 1;
    // Bad for 1/r on average, a share p / (p + r) of the time.
    CHECK(static_cast<double>(hits.size()) / kMany == Approx(0.02 / 0.27).margin(0.004));
    CHECK(static_cast<double>(hits.size()) / bursts == Approx(4.0).margin(0.15));
    spec.burst = Burst{0.02, 0.25, 0.6, 0.1};
    const double share = 0.02 / 0.27;
    CHECK(static_cast<double>(fired(spec, kMany).size()) / kMany ==
          Approx(share * 0.6 + (1 - share) * 0.1).margin(0.005));
}

TEST_CASE("a fault draws from its own stream, by seed and place in the list") {
    FaultSpec spec;
    spec.probability = 0.3;
    CHECK(fired(spec, 1000) == fired(spec, 1000));
    CHECK(fired(spec, 1000, 2) != fired(spec, 1000));
    CHECK(fired(spec, 10'000).size() == Approx(3000).margin(200));
}

TEST_CASE("instants: once, or again after each period, within the window") {
    FaultSpec spec;
    spec.begin = 5 * kMillisecond;
    spec.end = 16 * kMillisecond;
    const Trigger once(spec, fault_stream(spec, 1, 0));
    CHECK(once.instant(0) == spec.begin);
    CHECK(once.instant(spec.begin) == spec.begin);
    CHECK(once.instant(spec.begin + 1) == kNever);
    spec.period = 4 * kMillisecond;
    const Trigger often(spec, fault_stream(spec, 1, 0));
    std::vector<Time> instants;
    for (Time at = often.instant(0); at != kNever; at = often.instant(at + 1))
        instants.push_back(at / kMillisecond);
    CHECK(instants == std::vector<Time>{5, 9, 13});
}

TEST_CASE("evidence leaves out what came after the end") {
    RandomStream random(72, "evidence");
    Evidence evidence;
    std::vector<Time> times;
    Time now = 0;
    for (int i = 0; i < 3000; ++i) {
        now += static_cast<Time>(random.below(2 * kMillisecond));
        times.push_back(now);
        evidence.fire({now, static_cast<std::uint64_t>(i), "a", "0x41"}, now + kMillisecond);
    }
    // The end is never further back than what nodes run ahead.
    for (const std::size_t last : {2999u, 2998u, 2900u, 2500u}) {
        const Time end = times[last] + kMillisecond + 1;
        CHECK(evidence.fired(end) == last + 1);
        CHECK(evidence.last(end) == times[last]);
    }
    CHECK(evidence.firings().size() == Evidence::kMostKept);
    CHECK(evidence.firings(times[10] + kMillisecond).size() == 10);
    FaultReport report = report_of({"l", "", "drop"});
    CHECK(report.failed_to_fire());
    report.add(evidence, kNever);
    CHECK(report.fired == 3000);
    CHECK(report.last == times.back());
    CHECK_FALSE(Evidence().last());
}

TEST_CASE("trigger and evidence go into a saved state and come back") {
    FaultSpec spec;
    spec.probability = 0.4;
    spec.burst = Burst{0.1, 0.3};
    CarriedFault fault{spec, Trigger(spec, fault_stream(spec, 3, 0))};
    const auto play = [](CarriedFault& one, int from, int to) {
        for (int i = from; i < to; ++i)
            if (one.trigger.fires(i * kMillisecond))
                one.fired(i * kMillisecond, static_cast<std::uint64_t>(i), "x");
    };
    play(fault, 0, 100);
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    writer(fault);
    CarriedFault other{spec, Trigger(spec, fault_stream(spec, 9, 0))};
    StateReader reader(bytes);
    reader(other);
    play(fault, 100, 300);
    play(other, 100, 300);
    CHECK(other.evidence.firings() == fault.evidence.firings());
    CHECK(fault.evidence.fired() > 10);
}

TEST_CASE("a fault travels to its node and its evidence back") {
    RandomStream random(73, "json");
    for (int round = 0; round < 50; ++round) {
        FaultSpec spec;
        spec.kind = "nack";
        spec.node = "robot0.i2c";
        spec.link = round % 2 ? "robot0.i2c" : "";
        spec.name = "n";
        spec.probability = random.uniform();
        spec.count = random.next();
        spec.begin = static_cast<Time>(random.below(kSecond));
        spec.end = round % 3 ? kNever : spec.begin + 5;
        spec.skip = random.next();
        spec.every = random.next();
        spec.period = static_cast<Time>(random.below(kSecond));
        spec.bytes = {1, 255};
        spec.match = {0, 7};
        spec.offset = 3;
        if (round % 4) spec.position = 9;
        if (round % 5) spec.burst = Burst{random.uniform(), random.uniform(), 0.5, 0.25};
        spec.set("address", 32).set("phase", "data");
        nlohmann::ordered_json list;
        list.push_back(nlohmann::ordered_json::parse(fault_to_json(spec, random.next(), 4).dump()));
        std::vector<CarriedFault> faults = faults_from_json(list);
        REQUIRE(faults.size() == 1);
        CHECK(faults[0].spec == spec);
        faults[0].fired(77, 3, "a, b");
        FaultReport report = report_of(spec);
        add_fault_result(report, nlohmann::ordered_json::parse(fault_results(faults).dump())[0]);
        CHECK(report.fired == 1);
        CHECK(report.last == 77);
        CHECK(report.firings == faults[0].evidence.firings());
    }
    CHECK(faults_from_json({}).empty());
    CHECK_THROWS_AS(faults_from_json(nlohmann::ordered_json::parse("[{\"name\": 3}]")), InputError);
}
