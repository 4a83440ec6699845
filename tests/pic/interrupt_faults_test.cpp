// Interrupts that are lost or late, a battery's profile and dazzled proximity sensors, on a small firmware: a
// timer toggles an LED each millisecond, UART2 sends back each byte that it interrupts for.

#include "base/json.h"
#include "base/random.h"
#include "base/states/archive.h"
#include "emu/chip/translate/translation_switch.h"
#include "emu/pic/pic_node.h"
#include "tests/kit/board_faults.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>

using namespace puckloop;
using cosim::FaultSpec;
using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Time;
using tests::board_fault;

namespace {

constexpr Time kEnd = 60 * kMillisecond;
constexpr Time kBit = 8'680'556;

const std::string kFirmware = R"(
        .org 0x001A
        .pword step
        .org 0x0044
        .pword received
        .org 0x100
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        clr LATA
        bclr TRISA, #6
        mov #7, w0
        mov w0, U2BRG
        bset U2MODE, #15
        bset U2STA, #10
        bset IEC1, #8
        clr ADPCFG
        mov #8, w0
        mov w0, ADCHS
        mov #0x0113, w0
        mov w0, ADCON3
        mov #0x80E4, w0
        mov w0, ADCON1
        mov #14744, w0
        mov w0, PR1
        bset IEC0, #3
        bset T1CON, #15
wait:   bra wait
step:   bclr IFS0, #3
        btg LATA, #6
        retfie
received:
        bclr IFS1, #8
        mov U2RXREG, w1
        mov w1, U2TXREG
        retfie
)";

struct Bench {
    explicit Bench(const std::vector<FaultSpec>& specs, bool skip = true) {
        pic::PicNodeOptions options;
        options.board.name = "robot0.pic";
        options.board.adc_noise_counts = 0;
        options.i2c_linked = false;
        options.skip_idle = skip;
        for (std::size_t i = 0; i < specs.size(); ++i)
            options.faults.push_back(tests::carried(specs[i], i));
        node = std::make_unique<pic::PicNode>(tests::assembled(dspic::dspic30f6014a(), kFirmware), options);
    }
    /// Byte i begins to arrive at 2 + i ms.
    void run_with_bytes(Time until, int count) {
        std::vector<Message> inbox;
        for (int i = 0; i < count; ++i) {
            cosim::UartFrame frame;
            frame.start = (2 + i) * kMillisecond;
            frame.bit_period = kBit;
            frame.data = static_cast<std::uint16_t>(i + 1);
            inbox.push_back({frame.start + 9 * kBit, pic::PicNode::kUart2, frame});
        }
        node->advance(until, inbox, out);
    }
    std::vector<Time> toggles() const {
        std::vector<Time> times;
        for (const Message& message : out)
            if (const auto* signal = std::get_if<cosim::Signal>(&message.payload);
                signal && signal->id == pic::kLed)
                times.push_back(message.time);
        return times;
    }
    std::vector<int> echoes() const {
        std::vector<int> bytes;
        for (const Message& message : out)
            if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload))
                bytes.push_back(frame->data);
        return bytes;
    }
    nlohmann::json report() { return nlohmann::json::parse(node->finish()); }

    std::unique_ptr<pic::PicNode> node;
    std::vector<Message> out;
};

std::vector<Time> toggles_with(const std::vector<FaultSpec>& specs) {
    Bench bench(specs);
    bench.node->advance(kEnd, {}, bench.out);
    return bench.toggles();
}

FaultSpec of_timer(const char* kind) {
    return board_fault(kind).set("vector", "T1");
}

}  // namespace

TEST_CASE("lost interrupts are those that were asked for") {
    RandomStream random(1, "lost interrupts");
    const std::vector<Time> sound = toggles_with({});
    REQUIRE(sound.size() > 55);
    for (int i = 0; i < 6; ++i) {
        FaultSpec spec = of_timer("lost_interrupt");
        spec.skip = random.below(20);
        spec.every = 1 + random.below(7);
        spec.count = 1 + random.below(4);
        Bench bench({spec});
        bench.node->advance(kEnd, {}, bench.out);
        std::vector<Time> expected;
        std::vector<std::uint64_t> lost;
        for (std::size_t n = 0; n < sound.size(); ++n) {
            const bool hit = n >= spec.skip && (n - spec.skip) % spec.every == 0 && lost.size() < spec.count;
            if (hit)
                lost.push_back(n);
            else
                expected.push_back(sound[n]);
        }
        CHECK(bench.toggles() == expected);
        const nlohmann::json evidence = bench.report().at("faults").at(0);
        CHECK(evidence.at("fired") == lost.size());
        for (std::size_t n = 0; n < lost.size(); ++n) {
            CHECK(evidence.at("firings").at(n).at(1) == lost[n]);
            const Time at = evidence.at("firings").at(n).at(0);
            CHECK(std::abs(at - sound[lost[n]]) < 5 * kMicrosecond);
        }
    }
    FaultSpec share = of_timer("lost_interrupt");
    share.probability = 0.3;
    const auto left = toggles_with({share}).size();
    CHECK(left > sound.size() / 3);
    CHECK(left < sound.size());
}

TEST_CASE("late interrupts are late by as much") {
    RandomStream random(2, "late interrupts");
    const std::vector<Time> sound = toggles_with({});
    for (int i = 0; i < 6; ++i) {
        const Time delay = 1 + static_cast<Time>(random.below(900)) * kMicrosecond;
        FaultSpec spec = of_timer("late_interrupt").set("delay", cosim::to_seconds(delay)).set("jitter", 0.0);
        spec.every = 2 + random.below(5);
        const std::vector<Time> seen = toggles_with({spec});
        REQUIRE(seen.size() == sound.size());
        for (std::size_t n = 0; n < seen.size(); ++n) {
            const Time wanted = sound[n] + (n % spec.every == 0 ? delay : 0);
            CHECK(std::abs(seen[n] - wanted) < kMicrosecond);
        }
    }
    FaultSpec spread = of_timer("late_interrupt").set("delay", 300e-6).set("jitter", 200e-6);
    const std::vector<Time> seen = toggles_with({spread});
    Time least = kMillisecond, most = 0;
    for (std::size_t n = 0; n < seen.size(); ++n) {
        least = std::min(least, seen[n] - sound[n]);
        most = std::max(most, seen[n] - sound[n]);
    }
    CHECK(least > 99 * kMicrosecond);
    CHECK(most < 502 * kMicrosecond);
    CHECK(most - least > 250 * kMicrosecond);
}

TEST_CASE("lost interrupts of a receiver leave bytes behind, then it overruns") {
    FaultSpec spec = board_fault("lost_interrupt").set("vector", "U2RX");
    spec.skip = 5;
    spec.count = 1;
    Bench one({spec}), five({[&] {
        FaultSpec more = spec;
        more.count = 5;
        return more;
    }()});
    one.run_with_bytes(kEnd, 20);
    // From the lost one on the program is a byte behind.
    std::vector<int> expected;
    for (int byte = 1; byte < 20; ++byte)
        expected.push_back(byte);
    CHECK(one.echoes() == expected);
    CHECK(one.report().at("uart2").at("overruns") == 0);
    five.run_with_bytes(kEnd, 20);
    CHECK(five.report().at("uart2").at("overruns").get<int>() > 0);
    CHECK(five.echoes().size() < 16);
}

TEST_CASE("interrupt faults do not depend on cuts, skipping, translation, going back or saved states") {
    RandomStream random(3, "interrupt cuts");
    for (int i = 0; i < 8; ++i) {
        std::vector<FaultSpec> specs;
        const auto add = [&](FaultSpec spec) {
            spec.name += std::to_string(specs.size());
            spec.begin = static_cast<Time>(random.below(kEnd / 2));
            if (random.below(2) == 0) spec.end = spec.begin + 1 + static_cast<Time>(random.below(kEnd / 2));
            spec.probability = random.below(2) == 0 ? 1.0 : 0.5;
            spec.every = 1 + random.below(3);
            specs.push_back(spec);
        };
        add(of_timer("lost_interrupt"));
        add(of_timer("late_interrupt").set("delay", 3e-3 * random.uniform()).set("jitter", 1e-3));
        add(of_timer("late_interrupt").set("delay", 1e-5).set("jitter", 0.0));
        add(board_fault("interrupt").set("vector", "T1"));
        specs.back().period = 3 * kMillisecond;
        add(board_fault("reset"));
        add(board_fault("battery").set("profile", "0 s 4 V, 10 ms 3.2 V; 30ms 3.9"));
        specs.back().probability = 1.0;
        specs.back().every = 1;
        const auto run = [&](bool skip, bool cut) {
            Bench bench(specs, skip);
            if (!cut) bench.node->advance(kEnd, {}, bench.out);
            for (const Time until :
                 cut ? tests::random_cuts(random, 2 * kMillisecond, kEnd) : std::vector<Time>{}) {
                if (random.below(6) == 0) {  // saved, and loaded into another
                    std::vector<std::uint8_t> bytes;
                    StateWriter writer(bytes);
                    bench.node->state(writer);
                    Bench other(specs, skip);
                    StateReader reader(bytes);
                    other.node->state(reader);
                    reader.end();
                    bench.node = std::move(other.node);
                }
                if (random.below(3) == 0) {
                    std::vector<Message> nobody;
                    cosim::Rewindable& back = *bench.node->rewindable();
                    back.mark();
                    bench.node->advance(until + static_cast<Time>(random.below(5 * kMillisecond)), {},
                                        nobody);
                    back.rewind();
                    back.settle();
                }
                bench.node->advance(until, {}, bench.out);
            }
            std::stable_sort(bench.out.begin(), bench.out.end(),
                             [](const Message& a, const Message& b) { return a.port < b.port; });
            return std::pair(bench.out, bench.report().at("faults"));
        };
        const auto whole = run(true, false);
        CHECK(run(true, true) == whole);
        chip::set_translation(i % 2 == 0, 1);
        CHECK(run(false, true) == whole);
        chip::set_translation(true);
    }
}

TEST_CASE("a battery follows its profile") {
    FaultSpec spec = board_fault("battery").set("profile", "0 s 4.1 V, 20 ms 3.3 V, 40 ms 3.7 V");
    spec.begin = 10 * kMillisecond;
    spec.end = 90 * kMillisecond;
    Bench bench({spec});
    const auto volts = [&](Time at) {
        bench.node->advance(at, {}, bench.out);
        return bench.node->board().signal(pic::kBatteryVoltage);
    };
    const double before = volts(9 * kMillisecond);
    CHECK(volts(11 * kMillisecond) == Approx(4.1));
    CHECK(volts(21 * kMillisecond) == Approx(3.7));
    CHECK(bench.node->board().signal(pic::kBatteryLow) == 0);
    CHECK(volts(31 * kMillisecond) == Approx(3.3));
    CHECK(bench.node->board().signal(pic::kBatteryLow) == 1);
    CHECK(volts(41 * kMillisecond) == Approx(3.5));
    CHECK(volts(80 * kMillisecond) == Approx(3.7));
    CHECK(volts(95 * kMillisecond) == Approx(before));
    const nlohmann::json evidence = bench.report().at("faults").at(0);
    CHECK(evidence.at("fired") == 3);
    CHECK(evidence.at("firings").at(1).at(0) == 30 * kMillisecond);
    CHECK(evidence.at("firings").at(1).at(2) == "3.3 V");
}

TEST_CASE("ambient light swallows what a proximity sensor shows") {
    // AN8 is the first sensor; the firmware's last byte of it goes out with the echo's neighbour: read the
    // converter's buffer.
    const auto counts = [](const std::vector<FaultSpec>& specs) {
        Bench bench(specs);
        bench.node->advance(30 * kMillisecond, {}, bench.out);
        return bench.node->chip().peek("ADCBUF0");
    };
    const auto sound = counts({});
    REQUIRE(sound > 100);
    FaultSpec burst = board_fault("ambient_burst").set("sensor", 0.0).set("strength", 1.0);
    burst.begin = 20 * kMillisecond;
    CHECK(counts({burst}) == 0);
    CHECK(counts({burst.set("strength", 0.25)}) == Approx(0.75 * sound).margin(1));
    CHECK(counts({burst.set("sensor", 2)}) == sound);
    CHECK(counts({burst.set("sensor", 1)}) < sound);
    burst.end = 25 * kMillisecond;
    CHECK(counts({burst}) == sound);
}
