// The board as a node: what leaves does not depend on how grants are cut, EOTs hold, the log states
// what matters. Runs a small program of its own.

#include "base/json.h"
#include "base/random.h"
#include "emu/rab_board/rab_node.h"
#include "tests/kit/node_under_test.h"
#include "tests/kit/scratch.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <filesystem>
#include <map>

using namespace puckloop;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Message;
using cosim::Time;

namespace {

image::Image assembled(const std::string& source) {
    return tests::assembled(dspic::dspic33fj256gp710(), source);
}

// On the internal oscillator: a carrier of FCY / 85, all emitters toggled each 1000 cycles; as I2C slave 0x20
// it takes 600 cycles for each byte written, and a byte read is the upper half of PORTD.
const std::string kFirmware = R"(
        .org 0x001A
        .pword step
        .org 0x0034
        .pword slave
        .org 0x200
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        clr TRISB
        clr LATB
        bclr TRISF, #12
        bset LATF, #12
        mov #84, w0
        mov w0, PR2
        mov #42, w0
        mov w0, OC1R
        mov w0, OC1RS
        mov #6, w0
        mov w0, OC1CON
        bset T2CON, #15
        mov #999, w0
        mov w0, PR1
        bset T1CON, #15
        mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9040, w0
        mov w0, I2C1CON
        bset IEC0, #3
        bset IEC1, #0
wait:   bra wait

step:   bclr IFS0, #3
        com LATB
        retfie

slave:  bclr IFS1, #0
        mov I2C1RCV, w1
        btsc I2C1STAT, #2
        bra send
        repeat #600
        nop
        bset I2C1CON, #12
        retfie
send:   mov PORTD, w2
        lsr w2, #8, w2
        mov w2, I2C1TRN
        bset I2C1CON, #12
        retfie
)";

constexpr Time kClock = 10 * cosim::kMicrosecond;
constexpr Time kEnd = 30 * cosim::kMillisecond;

rab::RabNodeOptions quiet() {
    rab::RabNodeOptions options;
    options.board.name = "robot0.rab";
    options.board.adc_noise_counts = 0;
    return options;
}

Message phase_at(Time start, I2cPhaseKind kind, std::uint8_t byte, std::uint8_t ack = 0, Time late = 0) {
    return {start + late, rab::RabNode::kI2c, I2cPhase{kind, byte, ack, start, kClock, 0}};
}

/// Transfers with time to spare for each phase, one of them passed on late; receivers that see light.
std::vector<Message> some_inbox() {
    constexpr Time kStep = 400 * cosim::kMicrosecond;
    std::vector<Message> inbox;
    for (Time at = 2 * cosim::kMillisecond; at < 26 * cosim::kMillisecond; at += 4 * cosim::kMillisecond) {
        inbox.push_back(phase_at(at, I2cPhaseKind::Start, 0x40, 0, kClock / 2));
        inbox.push_back(phase_at(at + kStep, I2cPhaseKind::Write, 21));
        inbox.push_back(phase_at(at + 2 * kStep, I2cPhaseKind::Write, 7));
        inbox.push_back(phase_at(at + 3 * kStep, I2cPhaseKind::Start, 0x41));
        inbox.push_back(phase_at(at + 4 * kStep, I2cPhaseKind::Read, 0, 0));
        inbox.push_back(phase_at(at + 5 * kStep, I2cPhaseKind::Stop, 0));
        inbox.push_back(phase_at(at + 6 * kStep, I2cPhaseKind::Start, 0x42));
        inbox.push_back(phase_at(at + 7 * kStep, I2cPhaseKind::Stop, 0));
        const auto id = static_cast<rab::SignalId>(rab::kDemodulator + 4 + inbox.size() % 8);
        inbox.push_back({at + 3 * kStep + 333, rab::RabNode::kIr, cosim::Signal{id, 1}});
    }
    std::stable_sort(inbox.begin(), inbox.end(),
                     [](const Message& a, const Message& b) { return a.time < b.time; });
    return inbox;
}

/// Everything that leaves, port by port, when the time is granted in pieces that end at `cuts`.
std::map<int, std::vector<Message>> run_cut(const std::vector<Time>& cuts, bool skip,
                                            const std::string& log = {}, std::string* report = nullptr) {
    rab::RabNodeOptions options = quiet();
    options.skip_idle = skip;
    options.log = log;
    rab::RabNode node(assembled(kFirmware), options);
    const std::vector<Message> inbox = some_inbox();
    std::map<int, std::vector<Message>> out;
    std::size_t next = 0;
    for (const Time cut : cuts) {
        const std::size_t first = next;
        while (next < inbox.size() && inbox[next].time < cut)
            ++next;
        std::vector<Time> earliest;
        for (cosim::PortIndex port = 0; port < node.ports().size(); ++port) {
            const Time caused =
                next > first ? cosim::later(inbox[first].time, node.lookahead(port)) : cosim::kNever;
            earliest.push_back(std::min(node.earliest_output(port), caused));
        }
        std::vector<Message> outbox;
        node.advance(cut, std::span(inbox).subspan(first, next - first), outbox);
        for (const Message& message : outbox) {
            CHECK(message.time >= earliest[message.port]);
            auto& port = out[message.port];
            if (!port.empty()) CHECK(port.back().time <= message.time);
            port.push_back(message);
        }
    }
    const std::string json = node.finish();
    if (report != nullptr) *report = json;
    return out;
}

std::vector<Time> random_cuts(RandomStream& random, Time longest) {
    return tests::random_cuts(random, longest, kEnd);
}

using tests::contents;

}  // namespace

TEST_CASE("the ports of a range-and-bearing board are those that links name") {
    rab::RabNode node(assembled(kFirmware), quiet());
    REQUIRE(node.ports().size() == 5);
    CHECK(node.ports()[rab::RabNode::kUart1].name == "uart1");
    CHECK(node.ports()[rab::RabNode::kUart2].name == "uart2");
    CHECK(node.ports()[rab::RabNode::kI2c].name == "i2c");
    CHECK(node.ports()[rab::RabNode::kIr].name == "ir");
    CHECK(node.ports()[rab::RabNode::kWorld].name == "world");
    CHECK(node.name() == "robot0.rab");
}

TEST_CASE("firmware of a range-and-bearing board emits and answers its bus") {
    std::string report;
    const auto out = run_cut({kEnd}, true, {}, &report);
    std::map<int, std::vector<std::pair<Time, double>>> signals;
    for (const Message& message : out.at(rab::RabNode::kIr)) {
        const auto& signal = std::get<cosim::Signal>(message.payload);
        signals[signal.id].emplace_back(message.time, signal.value);
    }
    REQUIRE(signals[rab::kCarrier].size() == 1);
    const double cycle = 1 / (85 * signals[rab::kCarrier][0].second);
    CHECK(cycle == Approx(1 / 3.685e6).epsilon(0.01));
    for (int emitter = 0; emitter < 12; ++emitter) {
        const auto& edges = signals[rab::kEmitter + emitter];
        REQUIRE(edges.size() > 80);
        CHECK(edges[0].second == 1);
        CHECK(cosim::to_seconds(edges[11].first - edges[1].first) == Approx(10'000 * cycle));
    }
    const auto& answers = out.at(rab::RabNode::kI2c);
    REQUIRE(answers.size() == 6 * 6);
    std::uint8_t seen = 0xFF;
    for (std::size_t i = 0; i < answers.size(); i += 6) {
        const auto answer = [&](std::size_t k) { return std::get<I2cPhase>(answers[i + k].payload); };
        for (std::size_t k = 0; k < 6; ++k) {
            CHECK(answer(k).ack == (k == 5 || k == 4 ? answer(k).ack : 1));
            CHECK(answers[i + k].time == answer(k).start + 8 * kClock + answer(k).stretch);
        }
        CHECK(cosim::to_seconds(answer(2).stretch) == Approx(615 * cycle).margin(10 * cycle));
        CHECK(answer(4).kind == I2cPhaseKind::Data);
        CHECK((answer(4).byte & ~seen) == 0);  // more and more receivers see light
        CHECK(answer(4).byte != seen);
        seen = answer(4).byte;
        CHECK(answer(5).ack == 0);  // 0x21
    }
    const auto json = nlohmann::json::parse(report);
    CHECK(json["i2c"]["transfers"] == 12);
    CHECK(json["i2c"]["bad_payload_sizes"] == 6);
    CHECK(json["i2c"]["bytes_read"] == 6);
    CHECK(json["i2c"]["longest_stretch_s"].get<double>() == Approx(615 * cycle).margin(10 * cycle));
    CHECK(json["emission"]["irregular"] > 0);
    CHECK(json["kind"] == "range-and-bearing board, dsPIC33FJ256GP710");
    CHECK(json["unmodelled"].empty());
}

TEST_CASE("a board's messages are the same however the grants are cut") {
    const auto whole = run_cut({kEnd}, true);
    CHECK(run_cut({kEnd}, false) == whole);
    RandomStream random(21, "cuts");
    for (int round = 0; round < 4; ++round) {
        const Time longest = round == 0 ? 300 * cosim::kNanosecond : 200 * cosim::kMicrosecond;
        CHECK(run_cut(random_cuts(random, longest), round % 2 == 0) == whole);
    }
}

TEST_CASE("a board's log has what the firmware swallows, the same however the grants are cut") {
    const auto file = puckloop::tests::scratch_path("puckloop-rab-log-test.log");
    run_cut({kEnd}, true, file.string());
    const std::string log = contents(file);
    for (const char* line :
         {"[    0.000000 s] firmware test.s, ", "[    0.000000 s] power-on, reset POR\n",
          " s] carrier on, 43.4 kHz\n", "i2c: payload size 7 asked for, which is none of 8, 16, 24 or 32\n",
          ", 4 so far\n", "0 frames emitted, "})
        CHECK_THAT(log, Catch::Contains(line));
    RandomStream random(22, "cuts");
    for (const Time longest : {300 * cosim::kNanosecond, 25 * cosim::kMillisecond}) {
        run_cut(random_cuts(random, longest), true, file.string());
        CHECK(contents(file) == log);
    }
}

TEST_CASE("a bus that is no faster than announced gets no answer before the earliest time") {
    rab::RabNodeOptions options = quiet();
    options.fastest_i2c_hertz = 100e3;
    rab::RabNode node(assembled(kFirmware), options);
    std::vector<Message> outbox;
    node.advance(cosim::kMillisecond, {}, outbox);
    CHECK(node.earliest_output(rab::RabNode::kI2c) == cosim::kNever);
    CHECK(node.lookahead(rab::RabNode::kI2c) == 75 * cosim::kMicrosecond);
    // A master at 400 kHz: its phase is answered as one of 100 kHz.
    Message fast = phase_at(2 * cosim::kMillisecond, I2cPhaseKind::Start, 0x40);
    std::get<I2cPhase>(fast.payload).clock_period = kClock / 4;
    outbox.clear();
    node.advance(2 * cosim::kMillisecond + 1, std::span(&fast, 1), outbox);
    CHECK(node.earliest_output(rab::RabNode::kI2c) < 2 * cosim::kMillisecond + 8 * kClock);
    CHECK(node.earliest_output(rab::RabNode::kI2c) > 2 * cosim::kMillisecond + 7 * kClock);
    node.advance(3 * cosim::kMillisecond, {}, outbox);
    const auto answer = std::find_if(outbox.begin(), outbox.end(), [](const Message& message) {
        return message.port == rab::RabNode::kI2c;
    });
    REQUIRE(answer != outbox.end());
    CHECK(answer->time == 2 * cosim::kMillisecond + 8 * kClock);
}
