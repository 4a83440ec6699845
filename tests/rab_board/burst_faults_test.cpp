// Faults of the infra-red parts: bursts that an emitter or a demodulator misses, and a foreign carrier.

#include "base/json.h"
#include "base/random.h"
#include "emu/rab_board/rab_node.h"
#include "tests/kit/board_faults.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>

#include <map>
#include <set>

using namespace puckloop;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Time;
using tests::board_fault;

namespace {

// All emitters toggled each 1000 cycles, with a carrier from OC1.
const std::string kFirmware = R"(
        .org 0x001A
        .pword step
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
        bset IEC0, #3
wait:   bra wait
step:   bclr IFS0, #3
        com LATB
        retfie
)";

std::unique_ptr<rab::RabNode> board_with(const std::vector<cosim::FaultSpec>& specs) {
    rab::RabNodeOptions options;
    options.board.name = "robot0.rab";
    for (std::size_t i = 0; i < specs.size(); ++i)
        options.faults.push_back(tests::carried(specs[i], i));
    return std::make_unique<rab::RabNode>(tests::assembled(dspic::dspic33fj256gp710(), kFirmware), options);
}

/// Instants at which each emitter goes on, up to 30 ms.
std::map<int, std::set<Time>> bursts(rab::RabNode& node) {
    std::vector<Message> out;
    node.advance(30 * kMillisecond, {}, out);
    std::map<int, std::set<Time>> begins;
    for (const Message& message : out)
        if (const auto* signal = std::get_if<cosim::Signal>(&message.payload);
            signal && signal->id >= rab::kEmitter && signal->id < rab::kEmitter + 12 && signal->value != 0)
            begins[signal->id - rab::kEmitter + 1].insert(message.time);
    return begins;
}

double fired(rab::RabNode& node) {
    return nlohmann::json::parse(node.finish()).at("faults").at(0).at("fired");
}

}  // namespace

TEST_CASE("an emitter misses its bursts") {
    RandomStream random(1, "dead emitters");
    auto sound = bursts(*board_with({}));
    REQUIRE(sound.size() == 12);
    REQUIRE(sound[1].size() > 40);
    const int number = 1 + static_cast<int>(random.below(12));
    cosim::FaultSpec one = board_fault("emitter_dead").set("emitter", number);
    one.begin = 10 * kMillisecond;
    one.end = 20 * kMillisecond;
    const auto dead = board_with({one});
    auto sent = bursts(*dead);
    std::size_t lost = 0;
    for (int emitter = 1; emitter <= 12; ++emitter)
        for (const Time begin : sound[emitter]) {
            const bool hit = emitter == number && begin >= one.begin && begin < one.end;
            CHECK(sent[emitter].contains(begin) == !hit);
            lost += hit;
        }
    CHECK(fired(*dead) == static_cast<double>(lost));
    // Single chips of all twelve, which share each other's fate.
    cosim::FaultSpec chips = board_fault("emitter_dead").set("emitter", 0.0);
    chips.probability = 0.3;
    const auto weak = board_with({chips});
    sent = bursts(*weak);
    for (int emitter = 2; emitter <= 12; ++emitter)
        CHECK(sent[emitter] == sent[1]);
    const double share = 1 - static_cast<double>(sent[1].size()) / static_cast<double>(sound[1].size());
    CHECK(share > 0.1);
    CHECK(share < 0.5);
    CHECK(fired(*weak) == static_cast<double>(sound[1].size() - sent[1].size()));
}

TEST_CASE("a demodulator misses bursts, or sees a foreign carrier") {
    RandomStream random(2, "demodulators");
    for (int i = 0; i < 5; ++i) {
        const int number = 1 + static_cast<int>(random.below(12));
        const auto id = static_cast<rab::SignalId>(rab::kDemodulator + number - 1);
        const bool foreign = i % 2 == 0;
        cosim::FaultSpec spec =
            board_fault(foreign ? "foreign_carrier" : "receiver_dead").set("receiver", number);
        spec.begin = (5 + static_cast<Time>(random.below(5))) * kMillisecond;
        spec.end = spec.begin + (3 + static_cast<Time>(random.below(5))) * kMillisecond;
        const auto node = board_with({spec});
        std::vector<Message> out;
        bool lit = false;
        for (Time now = kMillisecond; now < 25 * kMillisecond; now += kMillisecond) {
            const bool before = lit;
            lit = random.below(2) == 0;
            const Message edge{now + kMillisecond / 2, rab::RabNode::kIr, cosim::Signal{id, lit ? 1.0 : 0.0}};
            const std::vector<Message> inbox =
                before == lit ? std::vector<Message>{} : std::vector<Message>{edge};
            node->advance(now + kMillisecond, inbox, out);
            const Time at = now + kMillisecond - 1;
            const bool held = at >= spec.begin && at < spec.end;
            const bool seen = node->board().signal(id) != 0;
            if (foreign)
                CHECK(seen == (lit || held));
            else if (edge.time >= spec.begin && edge.time < spec.end && before != lit)
                CHECK(!seen);
            else if (!lit)
                CHECK(!seen);
        }
    }
}
