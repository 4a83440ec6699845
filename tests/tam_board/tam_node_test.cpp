// The board as a node: what it sends is the same however grants are cut, saved or gone back, and never
// earlier than it said. The firmware is the project's own, or a small program.

#include "base/json.h"
#include "base/random.h"
#include "emu/avr/assembler/assembler.h"
#include "emu/tam_avr/tam_node.h"
#include "tests/kit/board_faults.h"
#include "tests/kit/files.h"
#include "tests/kit/scratch.h"
#include "tests/state/board_runs.h"
#include "tests/tam_board/rig.h"

#include <catch2/catch.hpp>

#include <array>
#include <cstdlib>
#include <map>

using namespace puckloop;
using namespace puckloop::tam;
using cosim::Message;
using cosim::Time;
using tests::run;

namespace {

constexpr Time kMs = cosim::kMillisecond;

/// Sleeps, and at each overflow of timer 0 (1.024 ms) sends a byte on the console, switches the emitter, and
/// at every eighth the module's reset.
const char* const kProgram = R"(
        .org 0
        jmp main
        .org 0x48
        jmp tick
        .org 0x100
main:   ldi r16, 0x40
        out 0x3e, r16
        ldi r16, 0xff
        out 0x3d, r16
        ldi r16, 0x02
        out 0x04, r16
        ldi r16, 0x80
        out 0x0a, r16
        ldi r16, 16
        sts 0xc4, r16
        ldi r16, 0x08
        sts 0xc1, r16
        ldi r16, 0x03
        out 0x25, r16
        ldi r16, 1
        sts 0x6e, r16
        out 0x33, r16
        sei
loop:   sleep
        sts 0xc6, r20
        rjmp loop
tick:   inc r20
        ldi r18, 0x02
        out 0x03, r18
        sbrc r20, 3
        sbi 0x0b, 7
        sbrs r20, 3
        cbi 0x0b, 7
        reti
)";

TamNodeOptions options(const std::string& log = {}) {
    TamNodeOptions result;
    result.board.name = "tam0.avr";
    result.board.resonator_ppm = 1234;
    result.network = 2;
    result.log = log;
    return result;
}

image::AvrImage own_image() {
    return image::load_avr_image(TAM_FIRMWARE, avr::atmega1284p().image_part());
}

}  // namespace

TEST_CASE("a board that is switched on later lives the same life, later") {
    const image::AvrImage image = test::assembled(kProgram);
    TamNode first(image, options());
    TamNodeOptions late = options();
    late.start = 30 * kMs + 7;
    TamNode second(image, late);
    CHECK(second.earliest_output(TamNode::kConsole) == late.start);
    std::vector<Message> now, later;
    first.advance(50 * kMs, {}, now);
    second.advance(80 * kMs + 7, {}, later);
    REQUIRE(now.size() > 50);
    REQUIRE(now.size() == later.size());
    for (std::size_t i = 0; i < now.size(); ++i) {
        CHECK(later[i].time == now[i].time + late.start);
        CHECK(later[i].port == now[i].port);
    }
    const auto report = nlohmann::json::parse(second.finish());
    CHECK(report["resets"][0]["time_s"] == Approx(0.030).margin(1e-6));
}

TEST_CASE("outputs go to the ports where they are of interest, and nowhere else") {
    TamNode node(own_image(), options());
    std::vector<Message> sent;
    node.advance(3 * cosim::kSecond, {}, sent);
    std::array<int, 5> count{};
    for (const Message& message : sent) {
        ++count[message.port];
        const auto* signal = std::get_if<cosim::Signal>(&message.payload);
        CHECK((signal != nullptr) == (message.port >= TamNode::kPins));
        if (signal != nullptr && message.port == TamNode::kPins) CHECK(signal->id == kXBeeReset);
    }
    CHECK(count[TamNode::kConsole] > 20);  // it greets
    CHECK(count[TamNode::kXBee] > 5);      // and asks its module
    CHECK(count[TamNode::kPins] == 2);     // which it has reset
    CHECK(count[TamNode::kIr] == 0);
    TamNodeOptions alone = options();
    alone.pins_linked = false;
    TamNode without(own_image(), alone);
    sent.clear();
    without.advance(500 * kMs, {}, sent);
    for (const Message& message : sent)
        CHECK(message.port != TamNode::kPins);
}

TEST_CASE("cuts, saved states and going back change nothing") {
    for (const bool own : {true, false}) {
        RandomStream random(5, own ? "own" : "program");
        const image::AvrImage image = own ? own_image() : test::assembled(kProgram);
        const std::string log = tests::scratch_path("tam.log").string();
        const std::string twin_log = tests::scratch_path("tam-twin.log").string();
        TamNodeOptions with_resets = options(log);
        with_resets.resets = {90 * kMs, 310 * kMs};
        TamNode node(image, with_resets);
        with_resets.log = twin_log;
        TamNode twin(image, with_resets);
        cosim::Rewindable& back = *node.rewindable();
        Time now = 0;
        for (int i = 0; i < 60; ++i) {
            INFO("mark " << i << " at " << cosim::to_seconds(now) << " s");
            back.mark();
            const Time ahead = now + 1 + static_cast<Time>(random.below(12 * kMs));
            run(node, tests::random_stretch(random, now, ahead, 200, kSignalCount));
            back.rewind();
            const bool same_bytes = tests::saved(node) == tests::saved(twin);
            REQUIRE(same_bytes);
            REQUIRE(tests::same_future(node, twin));
            if (random.below(2) == 0) back.settle();
            const Time until = now + 1 + static_cast<Time>(random.below(12 * kMs));
            tests::Stretch outside = tests::random_stretch(random, now, until, 200, kSignalCount);
            const auto sent = run(node, outside);
            outside.cuts = {until};
            const bool same_messages = sent == run(twin, outside);
            REQUIRE(same_messages);
            now = until;
            if (i % 10 != 0) continue;
            TamNodeOptions fresh = with_resets;
            fresh.log = {};
            TamNode copy(image, fresh);
            const auto bytes = tests::saved(twin);
            StateReader reader(bytes);
            copy.state(reader);
            reader.end();
            const bool same_copy = tests::saved(copy) == bytes;
            CHECK(same_copy);
            CHECK(tests::same_future(copy, twin));
        }
        back.settle();
        CHECK(node.finish() == twin.finish());
        CHECK(tests::text_of(log) == tests::text_of(twin_log));
    }
}

TEST_CASE("nothing is sent before the time that the node states") {
    RandomStream random(3, "eot");
    for (const bool own : {true, false}) {
        TamNode node(own ? own_image() : test::assembled(kProgram), options());
        Time now = 0;
        int later_than_now = 0;
        for (int i = 0; i < 3000; ++i) {
            std::vector<Time> earliest;
            for (cosim::PortIndex port = 0; port < node.ports().size(); ++port)
                earliest.push_back(node.earliest_output(port));
            later_than_now += earliest[TamNode::kIr] > now ? 1 : 0;
            const Time until = now + 1 + static_cast<Time>(random.below(200 * cosim::kMicrosecond));
            std::vector<Message> sent;
            node.advance(until, {}, sent);
            for (const Message& message : sent)
                REQUIRE(message.time >= earliest[message.port]);
            now = until;
        }
        CHECK(later_than_now > 1000);  // it sleeps most of the time, and reports it
    }
}

TEST_CASE("a board that is off has no earliest output time") {
    TamNodeOptions empty = options();
    empty.battery = 2.5;
    TamNode node(own_image(), empty);
    std::vector<Message> sent;
    node.advance(6 * cosim::kSecond, {}, sent);
    const auto report = nlohmann::json::parse(node.finish());
    CHECK(report["powered"] == false);
    CHECK(report["switched_off_s"] > 0.1);
    CHECK(node.earliest_output(TamNode::kXBee) == cosim::kNever);
    CHECK(node.lookahead(TamNode::kXBee) == cosim::kNever);
}

TEST_CASE("wrong fuses are named") {
    image::AvrImage image = own_image();
    image.fuses = {0x62, 0x99, 0xFF};
    TamNode node(image, options());
    const std::string warnings = nlohmann::json::parse(node.finish())["warnings"].dump();
    for (const char* word : {"CKDIV8", "CKSEL", "JTAGEN", "brown-out"})
        CHECK_THAT(warnings, Catch::Contains(word));
    image.fuses = {0xFF, 0xDE, 0xFD};  // without a boot loader
    TamNode other(image, options());
    CHECK_THAT(nlohmann::json::parse(other.finish())["warnings"].dump(),
               Catch::Contains("nothing is at 0x1FC00"));
    image.fuses = {0xF4, 0xDF, 0xFC};  // the supply is not enough, the crystal another one
    TamNode held(image, options());
    std::vector<cosim::Message> outbox;
    held.advance(100 * cosim::kMillisecond, {}, outbox);
    const auto report = nlohmann::json::parse(held.finish());
    CHECK_THAT(report["warnings"].dump(),
               Catch::Contains("holds the board in reset") && Catch::Contains("CKSEL"));
    CHECK(report["instructions"] == 0);
    TamNode good(own_image(), options());
    CHECK(nlohmann::json::parse(good.finish())["warnings"].empty());
}

TEST_CASE("interrupts of the board are lost, late, or come out of nowhere") {
    const image::AvrImage image = test::assembled(kProgram);
    const auto sent = [&](const cosim::FaultSpec& spec, nlohmann::json* evidence = nullptr) {
        TamNodeOptions with = options();
        with.faults = {tests::carried(spec)};
        TamNode node(image, with);
        std::vector<Message> out;
        node.advance(60 * kMs, {}, out);
        if (evidence != nullptr) *evidence = nlohmann::json::parse(node.finish()).at("faults").at(0);
        std::vector<Time> starts;
        for (const Message& message : out)
            if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload))
                starts.push_back(frame->start);
        return starts;
    };
    RandomStream random(10, "TAM interrupts");
    cosim::FaultSpec none = tests::board_fault("hang");
    none.begin = kMs * 1000;
    const std::vector<Time> sound = sent(none);
    REQUIRE(sound.size() > 55);
    for (int i = 0; i < 5; ++i) {
        cosim::FaultSpec spec = tests::board_fault("lost_interrupt").set("vector", "TIMER0_OVF");
        spec.skip = random.below(10);
        spec.every = 1 + random.below(5);
        spec.count = 1 + random.below(5);
        std::vector<Time> left;
        std::size_t lost = 0;
        for (std::size_t n = 0; n < sound.size(); ++n)
            if (n >= spec.skip && (n - spec.skip) % spec.every == 0 && lost < spec.count)
                ++lost;
            else
                left.push_back(sound[n]);
        nlohmann::json evidence;
        CHECK(sent(spec, &evidence) == left);
        CHECK(evidence.at("fired") == lost);
        const Time delay = 1 + static_cast<Time>(random.below(900)) * cosim::kMicrosecond;
        const std::vector<Time> late = sent(tests::board_fault("late_interrupt")
                                                .set("vector", "TIMER0_OVF")
                                                .set("delay", cosim::to_seconds(delay))
                                                .set("jitter", 0.0));
        REQUIRE(late.size() + 1 >= sound.size());
        for (std::size_t n = 0; n < late.size(); ++n)  // the transmitter begins at ticks of its own
            CHECK(std::abs(late[n] - sound[n] - delay) < 3 * cosim::kMicrosecond);
        cosim::FaultSpec nowhere = tests::board_fault("interrupt").set("vector", "TIMER0_OVF");
        nowhere.begin = sound[20] + 600 * cosim::kMicrosecond;
        const std::vector<Time> more = sent(nowhere, &evidence);
        REQUIRE(more.size() == sound.size() + 1);
        CHECK(std::abs(more[21] - nowhere.begin) < 5 * cosim::kMicrosecond);
        CHECK(evidence.at("fired") == 1);
        sent(nowhere.set("vector", "USART0_RX"), &evidence);  // is not enabled
        CHECK(evidence.at("fired") == 0);
    }
    cosim::FaultSpec unknown = tests::board_fault("lost_interrupt").set("vector", "U2RX");
    CHECK_THROWS_WITH(sent(unknown), Catch::Contains("no interrupt source 'U2RX'"));
}

TEST_CASE("a battery's profile and ambient light reach the converter") {
    const image::AvrImage image = test::assembled(kProgram);
    cosim::FaultSpec battery = tests::board_fault("battery", "battery").set("profile", "0 s 4 V, 20 ms 3 V");
    battery.begin = 5 * kMs;
    battery.end = 40 * kMs;
    cosim::FaultSpec light = tests::board_fault("ambient_burst", "light").set("sensor", 2).set("strength", 1);
    light.begin = 10 * kMs;
    light.end = 20 * kMs;
    TamNodeOptions with = options();
    with.faults = {tests::carried(battery, 0), tests::carried(light, 1)};
    TamNode node(image, with);
    std::vector<Message> out;
    const auto at = [&](Time time) {
        node.advance(time, {}, out);
        return node.board().signal(kBattery);
    };
    const double before = at(4 * kMs);
    CHECK(at(6 * kMs) == Approx(4.0));
    CHECK(at(16 * kMs) == Approx(3.5));
    CHECK(at(30 * kMs) == Approx(3.0));
    CHECK(at(45 * kMs) == Approx(before));
    const auto faults = nlohmann::json::parse(node.finish()).at("faults");
    CHECK(faults.at(0).at("fired") == 2);
    CHECK(faults.at(1).at("fired") == 1);
    CHECK(faults.at(1).at("firings").at(0).at(2) == "sensor 2");
    LightBarrier barrier{LightBarrierParameters{}};
    barrier.set_interrupted(1.0, 0);
    CHECK(barrier.volts(kMs) == Approx(0.0));
    barrier.set_glare(0.5);
    CHECK(barrier.volts(kMs) == Approx(1.65));
}

TEST_CASE("what a receiver's lost interrupts leave behind") {
    // Sends back what it receives, by interrupt.
    const image::AvrImage image = test::assembled(R"(
        .org 0
        jmp main
        .org 0x50
        jmp received
        .org 0x100
main:   ldi r16, 0x40
        out 0x3e, r16
        ldi r16, 0xff
        out 0x3d, r16
        ldi r16, 16
        sts 0xc4, r16
        ldi r16, 0x98
        sts 0xc1, r16
        sei
loop:   rjmp loop
received:
        lds r17, 0xc6
        sts 0xc6, r17
        reti
)");
    const auto echoes = [&](std::uint64_t lost, nlohmann::json& report) {
        TamNodeOptions with = options();
        with.board.resonator_ppm = 0;
        cosim::FaultSpec spec = tests::board_fault("lost_interrupt").set("vector", "USART0_RX");
        spec.skip = 4;
        spec.count = lost;
        with.faults = {tests::carried(spec)};
        TamNode node(image, with);
        std::vector<Message> in, out;
        for (int i = 0; i < 12; ++i) {
            cosim::UartFrame frame;
            frame.start = (2 + i) * 2 * kMs;
            frame.bit_period = 17 * cosim::kMicrosecond;
            frame.data = static_cast<std::uint16_t>(i + 1);
            in.push_back({frame.start + 9 * frame.bit_period, TamNode::kConsole, frame});
        }
        node.advance(40 * kMs, in, out);
        report = nlohmann::json::parse(node.finish());
        std::vector<std::pair<int, Time>> bytes;
        for (const Message& message : out)
            if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload))
                bytes.emplace_back(frame->data, frame->start);
        return bytes;
    };
    nlohmann::json report;
    const auto one = echoes(1, report);
    REQUIRE(one.size() == 12);
    for (int i = 0; i < 12; ++i)
        CHECK(one[static_cast<std::size_t>(i)].first == i + 1);
    CHECK(one[4].second > 14 * kMs);  // only the sixth byte brought the fifth
    CHECK(one[3].second < 11 * kMs);
    // Two bytes have room, and a third in the shift register; each one more takes the third's place. The
    // echo of the third finds the transmitter's buffer full.
    const auto five = echoes(5, report);
    std::vector<int> bytes;
    for (const auto& [byte, start] : five)
        bytes.push_back(byte);
    CHECK(bytes == std::vector{1, 2, 3, 4, 5, 6, 11, 12});
    CHECK(report.dump().find("\"overruns\":3") != std::string::npos);
}

TEST_CASE("faults of the board come at their time, whatever the cuts") {
    RandomStream random(9, "TAM faults");
    const image::AvrImage image = test::assembled(kProgram);
    const std::map<std::string, unsigned> causes{
        {"power_on", 0x01}, {"mclr", 0x02}, {"brown_out", 0x04}, {"watchdog", 0x08}};
    for (const auto& [cause, flag] : causes) {
        INFO(cause);
        TamNodeOptions with = options();
        with.start = 5 * kMs;
        cosim::FaultSpec reset = tests::board_fault("reset").set("cause", cause);
        reset.begin = 6 * kMs + static_cast<Time>(random.below(20 * kMs));
        with.faults = {tests::carried(reset)};
        TamNode node(image, with);
        std::vector<Message> out;
        node.advance(reset.begin, {}, out);
        CHECK(node.board().chip().report().resets.size() == 1);
        node.advance(reset.begin + kMs, {}, out);
        const auto resets = node.board().chip().report().resets;
        REQUIRE(resets.size() == 2);
        const Time at = with.start + node.board().chip().clock().time_of(resets[1].cycle);
        CHECK(std::abs(at - reset.begin) < 2 * cosim::kMicrosecond);
        CHECK((node.board().chip().peek("MCUSR") & flag) == flag);
        CHECK(nlohmann::json::parse(node.finish()).at("faults").at(0).at("fired") == 1);
    }
    for (int i = 0; i < 8; ++i) {
        std::vector<cosim::FaultSpec> specs;
        const auto add = [&](cosim::FaultSpec spec) {
            spec.name += std::to_string(specs.size());
            spec.begin = static_cast<Time>(random.below(50 * kMs));
            spec.period = 1 + static_cast<Time>(random.below(20 * kMs));
            spec.probability = 0.6;
            specs.push_back(spec);
        };
        add(tests::board_fault("reset").set("cause", "watchdog"));
        add(tests::board_fault("hang").set("duration", 5e-3 * random.uniform()));
        add(tests::board_fault("hang").set("duration", 1e-4).set("pc", "0x100").set("nth", 2));
        add(tests::board_fault("flip"));
        add(tests::board_fault("flip").set("space", "eeprom"));
        add(tests::board_fault("clock").set("ppm", 4e4 * (random.uniform() - 0.5)).set("drift", 100));
        add(tests::board_fault("interrupt").set("vector", "TIMER0_OVF"));
        add(tests::board_fault("lost_interrupt").set("vector", "TIMER0_OVF"));
        add(tests::board_fault("late_interrupt")
                .set("vector", "TIMER0_OVF")
                .set("delay", 3e-3 * random.uniform())
                .set("jitter", 1e-3));
        TamNodeOptions with = options();
        for (std::size_t k = 0; k < specs.size(); ++k)
            with.faults.push_back(tests::carried(specs[k], k));
        const std::string whole_log = tests::scratch_path("whole.log").string();
        const std::string cut_log = tests::scratch_path("cut.log").string();
        const Time end = 120 * kMs;
        with.log = whole_log;
        TamNode whole(image, with);
        with.log = cut_log;
        with.skip_idle = false;
        TamNode cut(image, with);
        std::vector<Message> once, parts;
        whole.advance(end, {}, once);
        cosim::Rewindable& back = *cut.rewindable();
        for (Time now = 0; now < end;) {
            const Time until = std::min(end, now + 1 + static_cast<Time>(random.below(4 * kMs)));
            if (random.below(3) == 0) {  // run ahead, and go back
                std::vector<Message> lost;
                back.mark();
                cut.advance(until + static_cast<Time>(random.below(9 * kMs)), {}, lost);
                back.rewind();
                back.settle();
            }
            cut.advance(until, {}, parts);
            now = until;
        }
        const auto by_port = [](const Message& a, const Message& b) { return a.port < b.port; };
        std::stable_sort(once.begin(), once.end(), by_port);
        std::stable_sort(parts.begin(), parts.end(), by_port);
        const bool same = once == parts;
        CHECK(same);
        CHECK(nlohmann::json::parse(whole.finish()).at("faults") ==
              nlohmann::json::parse(cut.finish()).at("faults"));
    }
}
