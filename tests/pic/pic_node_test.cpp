// The board as a node, with a small firmware of its own: UART2 echo, motor steps, LED, A/D converter.

#include "emu/pic/pic_node.h"

#include "base/json.h"
#include "base/random.h"
#include "tests/kit/node_under_test.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <map>

using namespace puckloop;
using cosim::Message;
using cosim::Time;

namespace {

image::Image assembled(const std::string& source) {
    return tests::assembled(dspic::dspic30f6014a(), source);
}

// Timer 1 turns the left motor one phase forward each 1 ms and toggles LED 0; the receiver of UART2 sends
// back each byte and the upper eight bits of what AN8 shows just then, with pulse 0 on.
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
        clr LATD
        clr LATF
        bclr TRISA, #6
        clr TRISD
        bclr TRISF, #7
        bset LATF, #7
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
        clr w5
wait:   bra wait

step:   bclr IFS0, #3
        dec w5, w5
        and w5, #3, w5
        btg LATA, #6
        bra w5
        bra phase0
        bra phase1
        bra phase2
        mov #0x9, w6
        bra out
phase0: mov #0xA, w6
        bra out
phase1: mov #0x6, w6
        bra out
phase2: mov #0x5, w6
out:    mov w6, LATD
        retfie

received:
        bclr IFS1, #8
        mov U2RXREG, w1
        mov w1, U2TXREG
        mov ADCBUF0, w2
        lsr w2, #4, w2
        mov w2, U2TXREG
        retfie
)";

pic::PicNodeOptions quiet() {
    pic::PicNodeOptions options;
    options.board.name = "robot0.pic";
    options.board.adc_noise_counts = 0;
    options.i2c_linked = false;
    return options;
}

constexpr Time kBit = 8'680'556;

Message byte_at(Time start, std::uint8_t byte) {
    cosim::UartFrame frame;
    frame.start = start;
    frame.bit_period = kBit;
    frame.data = byte;
    return {start + 9 * kBit, pic::PicNode::kUart2, frame};
}

Message signal_at(Time time, pic::SignalId id, double value) {
    return {time, pic::PicNode::kWorld, cosim::Signal{id, value}};
}

/// What goes in during 40 ms: bytes, and values that the world publishes each millisecond.
std::vector<Message> some_inbox() {
    std::vector<Message> inbox;
    for (int ms = 1; ms < 40; ++ms)
        inbox.push_back(signal_at(ms * cosim::kMillisecond, pic::kProximity, ms * 90));
    for (int i = 0; i < 30; ++i)
        inbox.push_back(byte_at((2 + i) * cosim::kMillisecond + i * 7919 * cosim::kNanosecond,
                                static_cast<std::uint8_t>(i)));
    std::stable_sort(inbox.begin(), inbox.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return inbox;
}

/// Everything that leaves, port by port, when the time is granted in pieces that end at `cuts`.
std::map<int, std::vector<Message>> run_cut(const std::vector<Time>& cuts, bool skip,
                                            const std::string& log = {}) {
    pic::PicNodeOptions options = quiet();
    options.board.adc_noise_counts = 1.5;
    options.skip_idle = skip;
    options.log = log;
    pic::PicNode node(assembled(kFirmware), options);
    const std::vector<Message> inbox = some_inbox();
    std::map<int, std::vector<Message>> out;
    std::size_t next = 0;
    for (const Time cut : cuts) {
        const std::size_t first = next;
        while (next < inbox.size() && inbox[next].time < cut)
            ++next;
        std::vector<Time> earliest;
        std::vector<bool> begun;
        for (cosim::PortIndex port = 0; port < node.ports().size(); ++port) {
            earliest.push_back(node.earliest_output(port));
            begun.push_back(node.begun(port).has_value());
        }
        const Time reached = node.earliest_output(pic::PicNode::kWorld);
        std::vector<Message> outbox;
        node.advance(cut, std::span(inbox).subspan(first, next - first), outbox);
        for (const Message& message : outbox) {
            CHECK(message.time >= earliest[message.port]);
            if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload)) {
                if (!begun[message.port]) CHECK(frame->start >= reached);
                begun[message.port] = false;  // one frame at most was on the line
            }
            auto& port = out[message.port];
            if (!port.empty()) CHECK(port.back().time <= message.time);
            port.push_back(message);
        }
    }
    if (!log.empty()) node.finish();
    return out;
}

/// Grants that end anywhere, none longer than `longest`.
std::vector<Time> random_cuts(RandomStream& random, Time longest) {
    return tests::random_cuts(random, longest, 40 * cosim::kMillisecond);
}

using tests::contents;

}  // namespace

TEST_CASE("the node's ports are those that links name") {
    pic::PicNode node(assembled(kFirmware), quiet());
    REQUIRE(node.ports().size() == 4);
    CHECK(node.ports()[pic::PicNode::kUart1].name == "uart1");
    CHECK(node.ports()[pic::PicNode::kUart2].name == "uart2");
    CHECK(node.ports()[pic::PicNode::kI2c].name == "i2c");
    CHECK(node.ports()[pic::PicNode::kWorld].name == "world");
    CHECK(node.name() == "robot0.pic");
}

TEST_CASE("firmware drives the wheels and the LED, and hears bytes and light") {
    const auto out = run_cut({40 * cosim::kMillisecond}, true);
    std::map<int, std::vector<double>> signals;
    for (const Message& message : out.at(pic::PicNode::kWorld))
        signals[std::get<cosim::Signal>(message.payload).id].push_back(
            std::get<cosim::Signal>(message.payload).value);
    REQUIRE(signals[pic::kWheelLeft].size() == 39);
    CHECK(signals[pic::kWheelLeft].back() == 39);  // down through the table is forward on the left
    CHECK(signals[pic::kLed].size() == 39);
    CHECK(signals[pic::kPulse] == std::vector<double>{1});
    const auto& frames = out.at(pic::PicNode::kUart2);
    REQUIRE(frames.size() >= 2 * 28);
    for (std::size_t i = 0; i + 1 < frames.size(); i += 2) {
        const auto& echo = std::get<cosim::UartFrame>(frames[i].payload);
        const auto& light = std::get<cosim::UartFrame>(frames[i + 1].payload);
        CHECK(echo.data == i / 2);
        CHECK(echo.bit_period == Approx(kBit).epsilon(1e-5));
        // The byte was there at (2.1 + i) ms: what the world said at (2 + i) ms was reflected by then.
        CHECK(light.data * 16 == Approx(3800 - 90 * (2 + static_cast<double>(i) / 2)).margin(25));
    }
}

TEST_CASE("however the grants are cut, the same messages leave at the same times") {
    const auto whole = run_cut({40 * cosim::kMillisecond}, true);
    CHECK(run_cut({40 * cosim::kMillisecond}, false) == whole);
    RandomStream random(11, "cuts");
    for (int round = 0; round < 4; ++round) {
        const Time longest = round == 0 ? 300 * cosim::kNanosecond : 400 * cosim::kMicrosecond;
        CHECK(run_cut(random_cuts(random, longest), round % 2 == 0) == whole);
    }
}

TEST_CASE("the log has what happened, the same however the grants are cut") {
    const auto file = puckloop::tests::scratch_path("puckloop-pic-log-test.log");
    const auto messages = run_cut({40 * cosim::kMillisecond}, true, file.string());
    CHECK(messages == run_cut({40 * cosim::kMillisecond}, true));  // looking disturbs nothing
    const std::string log = contents(file);
    for (const char* line : {
             "[    0.000000 s] firmware test.s, Intel HEX, ",
             "[    0.000000 s] power-on, reset POR\n",
             "[    0.002078 s] uart2: first character arrives, 0x00 at 115200 baud\n",
             " s] uart2: first character sent, 0x00 at 115200 baud\n",
             "[    0.001002 s] led0 on\n",
             " s] left motor runs forward from step 0\n",
             "[    0.040000 s] uart2: ",
             "[    0.040000 s] end: ",
             "wheels at 39 and 0 steps\n",
         })
        CHECK_THAT(log, Catch::Contains(line));
    RandomStream random(12, "cuts");
    for (const Time longest :
         {300 * cosim::kNanosecond, 400 * cosim::kMicrosecond, 25 * cosim::kMillisecond}) {
        run_cut(random_cuts(random, longest), true, file.string());
        CHECK(contents(file) == log);
    }
}

TEST_CASE("the log names resets, registers without a model and where in the program") {
    const auto file = puckloop::tests::scratch_path("puckloop-pic-log-test.log");
    image::Image image = assembled(R"(
        .org 0x100
main:   mov #0x1000, w15
        mov w0, BSRAM
        reset
)");
    image.symbols["_main"] = {.address = 0x100};
    pic::PicNodeOptions options = quiet();
    options.log = file.string();
    pic::PicNode node(image, options);
    std::vector<Message> outbox;
    node.advance(10 * cosim::kMicrosecond, {}, outbox);
    node.finish();
    const std::string log = contents(file);
    CHECK_THAT(log,
               Catch::Contains("first write of BSRAM, which is not modelled, at pc 0x0102 (_main+0x2)\n"));
    CHECK_THAT(log, Catch::Contains("reset SWR at pc 0x0104 (_main+0x4)\n"));
    CHECK(log.find("BSRAM") == log.rfind("BSRAM"));
}

TEST_CASE("errors on the line are logged when they first come and when they have doubled") {
    const auto file = puckloop::tests::scratch_path("puckloop-pic-log-test.log");
    pic::PicNodeOptions options = quiet();
    options.log = file.string();
    pic::PicNode node(assembled(kFirmware), options);
    std::vector<Message> inbox;
    for (int i = 0; i < 10; ++i) {
        Message message = byte_at((2 + 10 * i) * cosim::kMillisecond, 0);
        auto& frame = std::get<cosim::UartFrame>(message.payload);
        frame.bit_period = 2 * kBit;  // 57600 baud
        message.time = frame.start + 9 * frame.bit_period;
        inbox.push_back(message);
    }
    std::vector<Message> outbox;
    node.advance(110 * cosim::kMillisecond, inbox, outbox);
    node.finish();
    const std::string log = contents(file);
    CHECK_THAT(log, Catch::Contains("[    0.010000 s] uart2: framing errors so far: 1\n"));
    CHECK_THAT(log, Catch::Contains("[    0.020000 s] uart2: framing errors so far: 2\n"));
    CHECK_THAT(log, !Catch::Contains("so far: 3\n"));
    CHECK_THAT(log, Catch::Contains("so far: 8\n"));
}

TEST_CASE("with nobody on the bus a master's bytes are not acknowledged, and it does not hang") {
    pic::PicNode node(assembled(R"(
        .org 0x100
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        bclr TRISA, #6
        bclr TRISA, #7
        mov #150, w0
        mov w0, I2CBRG
        bset I2CCON, #15
        bset I2CCON, #0
start:  btss IFS0, #14
        bra start
        bclr IFS0, #14
        mov #0xC0, w0
        mov w0, I2CTRN
sent:   btss IFS0, #14
        bra sent
        btsc I2CSTAT, #15
        bset LATA, #6
        btss I2CSTAT, #15
        bset LATA, #7
wait:   bra wait
)"),
                      quiet());
    std::vector<Message> outbox;
    node.advance(2 * cosim::kMillisecond, {}, outbox);
    REQUIRE(outbox.size() == 1);
    CHECK(std::get<cosim::Signal>(outbox[0].payload).id == pic::kLed);
    // A start condition and nine clocks of 11.14 us.
    CHECK(cosim::to_seconds(outbox[0].time) == Approx(10 * 11.14e-6).epsilon(0.05));
}

TEST_CASE("the report of a node names what the chip went through") {
    pic::PicNode node(assembled(R"(
        .org 0x100
main:   mov #0x1000, w15
        mov w0, BSRAM
        reset
)"),
                      quiet());
    std::vector<Message> outbox;
    node.advance(10 * cosim::kMicrosecond, {}, outbox);
    const auto json = nlohmann::json::parse(node.finish());
    REQUIRE(json["resets"].size() > 2);
    CHECK(json["resets"][0]["cause"] == "POR");
    CHECK(json["resets"][1]["cause"] == "SWR");
    REQUIRE(json["unmodelled"].size() == 1);
    CHECK(json["unmodelled"][0]["name"] == "BSRAM");
    CHECK(json["unmodelled"][0]["pc"] == "0x0102");
    CHECK(json["wheel_steps"]["left"] == 0);
    CHECK(json["uart2"]["overruns"] == 0);
    CHECK(json["instructions"] > 10);
}
