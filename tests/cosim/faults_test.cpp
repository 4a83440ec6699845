#include "toy_run.h"

#include "base/error.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>

using namespace puckloop;
using namespace puckloop::cosim;
using toy::Recorder;
using toy::Run;

namespace {

constexpr Time kMs = kMillisecond;

/// One that talks at random, one that listens; the fault sits on what the first sends.
Run talk(FaultSpec fault) {
    fault.link = "wire";
    fault.from = "talker";
    Run run{{{"talker", "chatter seed=4 uarts=1 gap_us=150"}, {"listener", "idle"}},
            {toy::uart("wire", {"talker", "uart0"}, {"listener", "uart0"})},
            {fault}};
    run.options.duration = 100 * kMs;
    run.options.in_process = true;
    return run;
}

const UartFrame& frame(const TraceRecord& record) {
    return std::get<UartFrame>(record.payload);
}

struct Pair {
    std::vector<TraceRecord> clean, harmed;
    Outcome outcome;
};

Pair compare(const FaultSpec& fault) {
    Pair pair;
    Run run = talk(fault);
    Recorder harmed, clean;
    pair.outcome = run(&harmed);
    REQUIRE(pair.outcome.reason == EndReason::Duration);
    run.faults.clear();
    run(&clean);
    pair.clean = clean.records;
    pair.harmed = harmed.records;
    return pair;
}

}  // namespace

TEST_CASE("drop: marked, counted, not delivered") {
    const Pair pair = compare({"", "", "drop", 0.3});
    const std::uint64_t fired = pair.outcome.faults.at(0).fired;
    CHECK(pair.harmed.size() == pair.clean.size());
    CHECK(fired > pair.clean.size() / 5);
    CHECK(fired < pair.clean.size() / 2);
    CHECK(pair.outcome.links[0].from_a.lost == fired);
    CHECK(pair.outcome.links[0].from_a.uart_frames == pair.clean.size() - fired);
    CHECK_THAT(pair.outcome.nodes[1].json,
               Catch::Contains("\"messages\": " + std::to_string(pair.clean.size() - fired)));
}

TEST_CASE("a count ends a fault, and its random stream is its own") {
    const Pair pair = compare({"", "", "flip", 0.5, 7});
    CHECK(pair.outcome.faults.at(0).fired == 7);
    int flipped = 0;
    for (std::size_t i = 0; i < pair.clean.size(); ++i) {
        const unsigned difference = frame(pair.clean[i]).data ^ frame(pair.harmed[i]).data;
        if (pair.harmed[i].fault == FaultKind::None) {
            CHECK(difference == 0);
            continue;
        }
        ++flipped;
        CHECK(difference != 0);
        CHECK((difference & (difference - 1)) == 0);
        CHECK(difference < 256);
    }
    CHECK(flipped == 7);
}

TEST_CASE("delay shifts frame and delivery") {
    FaultSpec fault{"", "", "delay"};
    fault.count = 1;
    fault.begin = 10 * kMs;
    fault.set("delay", 0.02);
    const Pair pair = compare(fault);
    for (const TraceRecord& record : pair.harmed)
        if (record.fault == FaultKind::Delay) {
            CHECK(frame(record).start >= 30 * kMs);
            CHECK(record.time - frame(record).start < 80 * kMicrosecond);
        }
    CHECK(pair.outcome.faults.at(0).fired == 1);
}

TEST_CASE("duplicate: the frame comes again one frame later") {
    FaultSpec fault{"", "", "duplicate"};
    fault.count = 3;
    const Pair pair = compare(fault);
    CHECK(pair.harmed.size() == pair.clean.size() + 3);
}

TEST_CASE("disconnect: nothing begun within the window arrives") {
    FaultSpec fault{"", "", "disconnect"};
    fault.begin = 20 * kMs;
    fault.end = 30 * kMs;
    const Pair pair = compare(fault);
    for (const TraceRecord& record : pair.harmed) {
        const bool inside = frame(record).start >= fault.begin && frame(record).start < fault.end;
        CHECK(lost(record) == inside);
    }
    CHECK(pair.outcome.faults.at(0).fired > 10);
}

TEST_CASE("stuck: one break when the line goes low, then nothing until it is let go") {
    FaultSpec fault{"", "", "stuck"};
    fault.begin = 20 * kMs;
    fault.end = 30 * kMs;
    const Pair pair = compare(fault);
    int breaks = 0;
    for (const TraceRecord& record : pair.harmed)
        if (frame(record).is_break) {
            ++breaks;
            CHECK(frame(record).start == 20 * kMs);
            CHECK_FALSE(lost(record));
        }
    CHECK(breaks == 1);
    CHECK(pair.outcome.links[0].from_a.uart_breaks == 1);
}

TEST_CASE(
    "loopback: within the window the sender hears itself, and the other end nothing but with `through`") {
    for (const bool through : {false, true}) {
        FaultSpec fault{"", "", "loopback"};
        fault.begin = 20 * kMs;
        fault.end = 70 * kMs;
        if (through) fault.set("through", 1);
        Recorder recorder;
        const Outcome outcome = talk(fault)(&recorder);
        REQUIRE(outcome.reason == EndReason::Duration);
        std::uint64_t back = 0;
        for (const TraceRecord& record : recorder.records) {
            if (record.direction == Direction::FromB) {
                ++back;
                CHECK(record.fault == FaultKind::Loopback);
                continue;
            }
            const Time start = frame(record).start;
            const bool within = start >= fault.begin && start < fault.end;
            CHECK(record.fault == (within && !through ? FaultKind::Disconnect : FaultKind::None));
            const auto heard =
                std::find_if(recorder.records.begin(), recorder.records.end(), [&](const TraceRecord& other) {
                    return other.direction == Direction::FromB && other.time == record.time + kTurnRound &&
                           other.payload == record.payload;
                });
            CHECK((heard != recorder.records.end()) == within);
        }
        CHECK(back > 50);
        CHECK(outcome.faults.at(0).fired == back);
    }
}

TEST_CASE("rate: the receiver sees another bit time, the statistics count it") {
    FaultSpec fault{"", "", "rate"};
    fault.count = 5;
    fault.set("factor", 1.1);
    const Pair pair = compare(fault);
    CHECK(pair.outcome.links[0].from_a.uart_off_rate == 5);
    fault.set("factor", 0.9);
    CHECK(compare(fault).outcome.links[0].from_a.uart_off_rate == 5);
}

TEST_CASE("a fault that never fired is reported") {
    FaultSpec fault{"", "", "drop"};
    fault.begin = 500 * kMs;
    CHECK(talk(fault)().faults.at(0).failed_to_fire());
    fault.may_not_fire = true;
    const FaultReport report = talk(fault)().faults.at(0);
    CHECK_FALSE(report.failed_to_fire());
    CHECK(report.text == "drop on wire from talker");
    CHECK(report.name == "wire.drop");
    CHECK(report.firings.empty());
    CHECK_FALSE(report.last);
}

TEST_CASE("faults fire the same in every placement, and with the seed alone") {
    Run run = talk({"", "", "drop", 0.3});
    FaultSpec more{"wire", "", "delay", 0.2};
    more.set("delay", 0.0003);
    run.faults.push_back(more);
    const Outcome here = run();
    run.options.chop_seed = 5;
    CHECK(run().trace_sha256 == here.trace_sha256);
    run.options.in_process = false;
    const Outcome there = run();
    CHECK(there.trace_sha256 == here.trace_sha256);
    CHECK(there.faults[1].fired == here.faults[1].fired);
    run.options.seed = 2;
    CHECK(run().trace_sha256 != here.trace_sha256);
}

TEST_CASE("cut: a record loses its end, and the next one often does too") {
    FaultSpec spec{"wire", "", "cut", 0.1};
    spec.set("again", 0.5);
    const auto fault = make_fault(spec, {}, 3, 0);
    constexpr int kRecords = 4000, kBytes = 20;
    int broken = 0, again = 0, after_broken = 0;
    bool last = false;
    double places = 0;
    for (int record = 0; record < kRecords; ++record) {
        int lost_from = kBytes;
        for (int k = 0; k < kBytes; ++k) {
            UartFrame byte;
            byte.bit_period = 8'680'556;
            byte.start = record * 100 * kMs + k * 10 * byte.bit_period;
            std::vector<Delivery> batch{{Message{byte.start, 0, byte}, FaultKind::None}};
            fault->apply(batch, {});
            if (batch[0].fault != FaultKind::None) lost_from = std::min(lost_from, k);
            CHECK((batch[0].fault == FaultKind::Cut) == (k >= lost_from));  // all the rest
        }
        const bool now = lost_from < kBytes;
        broken += now ? 1 : 0;
        after_broken += last ? 1 : 0;
        again += last && now ? 1 : 0;
        if (now) places += lost_from;
        last = now;
    }
    // In the long run p / (1 - (1 - p) again) of all; after a broken one p + (1 - p) again.
    CHECK(broken / static_cast<double>(kRecords) == Approx(0.1 / 0.55).margin(0.02));
    CHECK(again / static_cast<double>(after_broken) == Approx(0.55).margin(0.05));
    CHECK(places / broken == Approx((kBytes - 1) / 2.0).margin(1.0));
    CHECK(fault->evidence().fired() == static_cast<std::uint64_t>(broken));
}

TEST_CASE("only the bytes that are named suffer") {
    FaultSpec named{"", "", "drop"};
    named.bytes = {0x00, 0xFF};
    const auto fault = make_fault(named, {}, 1, 0);
    for (unsigned value = 0; value < 256; ++value) {
        UartFrame byte;
        byte.data = static_cast<std::uint16_t>(value);
        std::vector<Delivery> batch{{Message{0, 0, byte}, FaultKind::None}};
        fault->apply(batch, {});
        CHECK((batch[0].fault == FaultKind::Drop) == (value == 0x00 || value == 0xFF));
    }
}

TEST_CASE("radio frames are lost, flipped, delayed and doubled as bytes are") {
    const std::vector<std::uint8_t> octets{0x41, 0x88, 0x07};
    const RadioFrame sent{5 * kMs, 288 * kMicrosecond, Octets(octets), 12, -60};
    const WireSite kAir{Direction::FromA, 0, 0, PlaceKind::Radio};
    const auto harmed = [&](const FaultSpec& spec) {
        const auto fault = make_fault(spec, kAir, 1, 0);
        std::vector<Delivery> batch{{Message{sent.start + sent.duration, 0, sent}, FaultKind::None}};
        fault->apply(batch, {});
        return batch;
    };
    const auto frame_of = [](const Delivery& one) { return std::get<RadioFrame>(one.message.payload); };
    CHECK(harmed({"", "", "drop"}).at(0).fault == FaultKind::Drop);
    CHECK(harmed({"", "", "drop", 1.0, 1, 0, 5 * kMs}).at(0).fault == FaultKind::None);
    // What module and network layer say to each other beside the air is out of reach.
    {
        RadioFrame word = sent;
        word.duration = 0;
        const auto fault = make_fault({"", "", "drop"}, kAir, 1, 0);
        std::vector<Delivery> batch{{Message{word.start, 0, word}, FaultKind::None}};
        fault->apply(batch, {});
        CHECK(batch.at(0).fault == FaultKind::None);
    }
    const auto late = harmed(FaultSpec{"", "", "delay"}.set("delay", 0.002));
    CHECK(late.at(0).message.time == sent.start + sent.duration + 2 * kMs);
    CHECK(frame_of(late[0]).start == sent.start + 2 * kMs);
    const auto twice = harmed({"", "", "duplicate"});
    REQUIRE(twice.size() == 2);
    CHECK(twice[1].message.time == sent.start + 2 * sent.duration);
    CHECK(frame_of(twice[1]).octets == sent.octets);
    const auto flipped = frame_of(harmed({"", "", "flip"}).at(0)).octets.view();
    REQUIRE(flipped.size() == octets.size());
    int bits = 0;
    for (std::size_t i = 0; i < octets.size(); ++i)
        bits += std::popcount(static_cast<unsigned>(octets[i] ^ flipped[i]));
    CHECK(bits == 1);
}

TEST_CASE("octets compare by content") {
    const std::vector<std::uint8_t> one{1, 2}, other{1, 3};
    CHECK(Octets(one) == Octets(std::vector<std::uint8_t>{1, 2}));
    CHECK_FALSE(Octets(one) == Octets(other));
    CHECK(Octets() == Octets(std::span<const std::uint8_t>{}));
    CHECK(Octets().view().empty());
}

TEST_CASE("faults that make no sense are refused") {
    Run run = talk({"", "", "drop", 1.5});
    CHECK_THROWS_WITH(run(), Catch::Contains("bad probability") && Catch::Contains("0 to 1"));
    run = talk({"", "", "drop"});
    run.faults[0].link = "none";
    CHECK_THROWS_WITH(run(), Catch::Contains("fault on link none") && Catch::Contains("no such link"));
    run = talk({"", "", "drop"});
    run.faults[0].from = "nobody";
    CHECK_THROWS_WITH(run(), Catch::Contains("no node nobody"));
    run = talk({"", "", "rate"});
    CHECK_THROWS_AS(run(), InputError);
    run = talk({"", "", "cut"});
    run.faults[0].set("again", -1);
    CHECK_THROWS_WITH(run(), Catch::Contains("bad again of cut"));
    CHECK(fault_of_name("stuck") == FaultKind::Stuck);
    CHECK(fault_of_name("") == std::nullopt);
    CHECK(fault_of_name("explode") == std::nullopt);
}
