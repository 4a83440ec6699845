// Faults of a board and its chip, each with drawn times and values, on a small firmware: a timer turns the
// left motor and toggles an LED each millisecond, UART2 echoes what AN8 shows.

#include "tests/kit/board_faults.h"

#include "base/json.h"
#include "base/random.h"
#include "base/states/archive.h"
#include "emu/chip/translate/translation_switch.h"
#include "emu/pic/pic_node.h"
#include "tests/kit/node_under_test.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>

using namespace puckloop;
using cosim::FaultSpec;
using cosim::kMillisecond;
using cosim::Message;
using cosim::Time;
using tests::board_fault;

namespace {

constexpr Time kEnd = 60 * kMillisecond;
constexpr std::uint32_t kStep = 0x200;  // the timer's routine

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
        bclr TRISA, #6
        clr TRISD
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
        .org 0x200
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
        mov ADCBUF0, w2
        lsr w2, #4, w2
        mov w2, U2TXREG
        retfie
)";

pic::PicNodeOptions options_with(const std::vector<FaultSpec>& specs) {
    pic::PicNodeOptions options;
    options.board.name = "robot0.pic";
    options.board.adc_noise_counts = 0;
    options.i2c_linked = false;
    for (std::size_t i = 0; i < specs.size(); ++i)
        options.faults.push_back(tests::carried(specs[i], i));
    return options;
}

struct Bench {
    explicit Bench(const std::vector<FaultSpec>& specs, bool skip = true)
        : node([&] {
              pic::PicNodeOptions options = options_with(specs);
              options.skip_idle = skip;
              return std::make_unique<pic::PicNode>(tests::assembled(dspic::dspic30f6014a(), kFirmware),
                                                    options);
          }()) {}

    void run(Time until) { node->advance(until, {}, out); }
    std::vector<Time> toggles() const {
        std::vector<Time> times;
        for (const Message& message : out)
            if (const auto* signal = std::get_if<cosim::Signal>(&message.payload);
                signal && signal->id == pic::kLed)
                times.push_back(message.time);
        return times;
    }
    /// The evidence of fault `i`.
    nlohmann::json evidence(std::size_t i = 0) {
        return nlohmann::json::parse(node->finish()).at("faults").at(i);
    }

    std::unique_ptr<pic::PicNode> node;
    std::vector<Message> out;
};

Time drawn(RandomStream& random, Time from, Time to) {
    return from + static_cast<Time>(random.below(static_cast<std::uint64_t>(to - from)));
}

FaultSpec once(FaultSpec spec, Time at) {
    spec.begin = at;
    spec.count = 1;
    return spec;
}

}  // namespace

TEST_CASE("a reset comes at its time and leaves its mark in RCON") {
    RandomStream random(1, "reset faults");
    const std::map<std::string, std::pair<unsigned, std::string>> causes{
        {"mclr", {0x80, "EXTR"}},
        {"software", {0x40, "SWR"}},
        {"watchdog", {0x10, "WDTO"}},
        {"brown_out", {0x02, "BOR"}},
        {"power_on", {0x03, "POR"}},
        {"trap", {0x8000, "TRAPR"}},
        {"illegal_opcode", {0x4000, "IOPUWR"}}};
    for (const auto& [cause, mark] : causes) {
        INFO(cause);
        const Time at = drawn(random, kMillisecond, kEnd / 2);
        Bench bench({once(board_fault("reset"), at).set("cause", cause)});
        bench.run(at);
        const unsigned before = bench.node->chip().peek("RCON");
        CHECK(bench.node->chip().report().resets.size() == 1);
        bench.run(kEnd);
        const unsigned after = bench.node->chip().peek("RCON");
        constexpr unsigned kCauses = 0xC0D3;
        CHECK((after & kCauses) == (cause == "power_on" ? mark.first : (before | mark.first) & kCauses));
        const auto resets = bench.node->chip().report().resets;
        REQUIRE(resets.size() == 2);
        CHECK(resets[1].cause == mark.second);
        const Time reset = bench.node->chip().clock().time_of(resets[1].cycle);
        CHECK(reset - at < cosim::kMicrosecond);
        const nlohmann::json evidence = bench.evidence();
        CHECK(evidence.at("fired") == 1);
    }
}

TEST_CASE("a reset where the program arrives for the n-th time") {
    RandomStream random(2, "reset at pc");
    for (int i = 0; i < 6; ++i) {
        const auto nth = 1 + random.below(40);
        Bench bench({board_fault("reset").set("pc", "0x200").set("nth", static_cast<double>(nth))},
                    i % 2 == 0);
        bench.run(2 * kEnd);
        const auto resets = bench.node->chip().report().resets;
        REQUIRE(resets.size() == 2);
        CHECK(resets[1].pc == kStep);
        const Time reset = bench.node->chip().clock().time_of(resets[1].cycle);
        const std::vector<Time> toggles = bench.toggles();
        CHECK(std::count_if(toggles.begin(), toggles.end(), [&](Time t) { return t < reset; }) ==
              static_cast<std::ptrdiff_t>(nth - 1));
        CHECK(std::abs(static_cast<double>(reset) - static_cast<double>(nth) * kMillisecond) <
              2e-5 * cosim::kSecond);
    }
}

TEST_CASE("a hang stops the program, and it goes on where it was") {
    RandomStream random(3, "hang");
    for (int i = 0; i < 5; ++i) {
        const Time at = drawn(random, 5 * kMillisecond, kEnd / 2);
        const Time duration = drawn(random, 2 * kMillisecond, 20 * kMillisecond);
        Bench bench({once(board_fault("hang"), at).set("duration", cosim::to_seconds(duration))}, i % 2 == 0);
        bench.run(kEnd);
        for (const Time toggle : bench.toggles())
            CHECK((toggle < at + cosim::kMicrosecond || toggle >= at + duration));
        CHECK(bench.node->chip().report().resets.size() == 1);
        CHECK(bench.toggles().back() > kEnd - 2 * kMillisecond);
        CHECK(bench.evidence().at("fired") == 1);
    }
}

TEST_CASE("a brown-out holds the board in reset") {
    const Time at = 7 * kMillisecond + 1234567, duration = 11 * kMillisecond;
    Bench bench({once(board_fault("brown_out"), at).set("duration", cosim::to_seconds(duration))});
    bench.run(at + duration / 2);
    CHECK(bench.node->chip().peek("TRISD") == 0xFFFF);
    bench.run(kEnd);
    CHECK(bench.node->chip().peek("TRISD") == 0);
    CHECK((bench.node->chip().peek("RCON") & 2) == 2);
}

TEST_CASE("a flipped bit is one bit") {
    RandomStream random(4, "flips");
    for (int i = 0; i < 40; ++i) {
        const Time at = drawn(random, 2 * kMillisecond, 9 * kMillisecond);
        const std::string space = i % 3 == 0 ? "ram" : i % 3 == 1 ? "flash" : "eeprom";
        FaultSpec spec = once(board_fault("flip"), at).set("space", space);
        const bool chosen = random.below(2) == 0;
        const auto place = static_cast<std::uint32_t>(random.below(0x600)) * 2;
        const std::uint32_t address = space == "ram"     ? 0x1800 + place
                                      : space == "flash" ? 0x8000 + place
                                                         : 0x7FF000 + place;
        const auto bit = static_cast<unsigned>(random.below(16));
        if (chosen) spec.set("address", address).set("bit", bit);
        Bench bench({spec});
        bench.run(at);
        const auto before = bench.node->chip().memory();
        std::map<unsigned, unsigned> ram;
        for (unsigned a = 0x800; a < 0x2800; a += 2)
            ram[a] = bench.node->chip().peek_data(static_cast<std::uint16_t>(a));
        bench.run(at + 1);
        int differences = 0;
        for (const auto& [a, word] : ram)
            if (const unsigned now = bench.node->chip().peek_data(static_cast<std::uint16_t>(a));
                now != word) {
                differences += std::popcount(now ^ word);
                if (chosen) CHECK((a == address && (now ^ word) == 1u << bit));
            }
        auto after = bench.node->chip().memory();
        for (const auto& [a, word] : before)
            after[a] ^= word;  // where a word became or was erased it is missing on one side
        for (const auto& [a, change] : after) {
            const std::uint32_t erased = a >= 0x7FF000 && a < 0x800000 ? 0xFFFF : 0xFFFFFF;
            const std::uint32_t flipped = before.contains(a) ? change : change ^ erased;
            if (flipped == 0 || a >= 0xF80000) continue;
            differences += std::popcount(flipped);
            if (chosen) CHECK((a == address && flipped == 1u << bit));
        }
        CHECK(differences == 1);
        CHECK(bench.evidence().at("fired") == 1);
    }
}

TEST_CASE("a flipped bit of a register acts") {
    // T1CON<TON>: no more toggles. U2BRG: another bit time, seen as stored.
    Bench stopped({once(board_fault("flip"), 20 * kMillisecond)
                       .set("space", "register")
                       .set("symbol", "T1CON")
                       .set("bit", 15)});
    stopped.run(kEnd);
    CHECK(stopped.toggles().size() >= 18);
    CHECK(stopped.toggles().back() <= 20 * kMillisecond);
    Bench baud({once(board_fault("flip"), 20 * kMillisecond)
                    .set("space", "register")
                    .set("symbol", "U2BRG")
                    .set("bit", 4)});
    baud.run(kEnd);
    CHECK(baud.node->chip().peek("U2BRG") == (7 ^ 16));
    Bench w5({once(board_fault("flip"), 20 * kMillisecond + 300 * cosim::kMicrosecond)
                  .set("space", "register")
                  .set("symbol", "W5")
                  .set("bit", 1)});
    w5.run(kEnd);
    Bench sound({});
    sound.run(kEnd);
    // One step the other way.
    CHECK(std::abs(w5.node->board().left_motor().steps() - sound.node->board().left_motor().steps()) == 2);
}

TEST_CASE("a clock's error and drift count") {
    RandomStream random(5, "clock");
    for (int i = 0; i < 4; ++i) {
        const double ppm = 80'000 * (2 * random.uniform() - 1);
        const double drift = i % 2 == 0 ? 0 : 60'000 * (2 * random.uniform() - 1);
        const Time begin = drawn(random, kMillisecond, 20 * kMillisecond);
        const Time end = begin + drawn(random, 200 * kMillisecond, 300 * kMillisecond);
        FaultSpec spec = board_fault("clock").set("ppm", ppm).set("drift", drift);
        spec.begin = begin;
        spec.end = end;
        Bench nominal({}), off({spec});
        const Time last = end + 50 * kMillisecond;
        nominal.run(last);
        off.run(last);
        const double seconds = cosim::to_seconds(end - begin);
        // Milliseconds gained; the drift's staircase is right at its steps and at the window's end.
        const double gained = 1e3 * (ppm * 1e-6 * seconds + drift * 1e-6 * seconds * seconds / 2);
        const double seen = static_cast<double>(off.node->chip().cycle()) / 14745.6 -
                            static_cast<double>(nominal.node->chip().cycle()) / 14745.6;
        CHECK(std::abs(seen - gained) < 1e-3);
        CHECK(std::abs(static_cast<double>(off.toggles().size()) -
                       static_cast<double>(nominal.toggles().size()) - gained) <= 1.01);
        CHECK(off.evidence().at("fired") == 1);
    }
}

TEST_CASE("what the converter reads may be stuck, shifted, scaled or noisy") {
    RandomStream random(6, "adc");
    constexpr Time kBit = 8'680'556;
    const auto readings = [&](const std::vector<FaultSpec>& specs) {
        pic::PicNodeOptions options = options_with(specs);
        pic::PicNode node(tests::assembled(dspic::dspic30f6014a(), kFirmware), options);
        std::vector<Message> inbox, out;
        for (int ms = 2; ms < 40; ++ms) {
            cosim::UartFrame frame;
            frame.start = ms * kMillisecond;
            frame.bit_period = kBit;
            frame.data = 1;
            inbox.push_back({frame.start + 9 * kBit, pic::PicNode::kUart2, frame});
        }
        node.advance(kEnd, inbox, out);
        std::vector<int> values;
        for (const Message& message : out)
            if (const auto* frame = std::get_if<cosim::UartFrame>(&message.payload))
                values.push_back(frame->data);
        return values;
    };
    const auto sound = readings({});
    REQUIRE(sound.size() == 38);
    const double value = random.uniform();
    const auto in_window = [&](FaultSpec spec) {
        spec.begin = 20 * kMillisecond;
        spec.end = 30 * kMillisecond;
        return readings({spec.set("channel", 8)});
    };
    const auto inside = [](std::size_t i) { return i >= 19 && i < 28; };  // byte i comes at 2 + i ms
    const auto compare = [&](const std::vector<int>& seen, auto expected, int tolerance) {
        REQUIRE(seen.size() == sound.size());
        for (std::size_t i = 0; i < seen.size(); ++i)
            if (i < 17 || i > 29)
                CHECK(seen[i] == sound[i]);
            else if (inside(i))
                CHECK(std::abs(seen[i] - expected(sound[i])) <= tolerance);
    };
    compare(
        in_window(board_fault("adc_stuck").set("value", value)),
        [&](int) { return static_cast<int>(value * 256); }, 1);
    compare(
        in_window(board_fault("adc_offset").set("value", -0.4)),
        [&](int reading) { return std::max(0, reading - 102); }, 1);
    compare(
        in_window(board_fault("adc_gain").set("factor", 0.3)),
        [&](int reading) { return static_cast<int>(reading * 0.3); }, 1);
    const auto noisy = in_window(board_fault("adc_noise").set("sigma", 0.2));
    int different = 0;
    for (std::size_t i = 0; i < noisy.size(); ++i)
        if (inside(i)) different += noisy[i] != sound[i];
    CHECK(different >= 7);
    FaultSpec other = board_fault("adc_stuck").set("value", value).set("channel", 9);
    CHECK(readings({other}) == sound);
}

TEST_CASE("a wheel that is stuck, or whose winding is open, does not turn") {
    RandomStream random(7, "wheels");
    for (const char* kind : {"wheel_stall", "phase_open"}) {
        FaultSpec spec = board_fault(kind).set("motor", "left");
        spec.begin = drawn(random, 10 * kMillisecond, 20 * kMillisecond);
        spec.end = drawn(random, 30 * kMillisecond, 40 * kMillisecond);
        Bench bench({spec}), sound({});
        bench.run(kEnd);
        sound.run(kEnd);
        const auto steps = [](const Bench& b) {
            std::map<Time, double> at;
            for (const Message& message : b.out)
                if (const auto* signal = std::get_if<cosim::Signal>(&message.payload);
                    signal && signal->id == pic::kWheelLeft)
                    at[message.time] = signal->value;
            return at;
        };
        const auto turned = steps(bench), nominal = steps(sound);
        double lost = 0;
        for (const auto& [time, value] : nominal) {
            const bool within = time >= spec.begin && time < spec.end;
            CHECK(turned.contains(time) == !within);
            lost += within;
            if (!within) CHECK(value - turned.at(time) == (time < spec.begin ? 0 : lost));
        }
        CHECK(bench.evidence().at("fired") == lost);
        CHECK(lost > 8);
    }
}

TEST_CASE("a sagging battery is low") {
    FaultSpec spec = board_fault("sag").set("volts", 0.9);
    spec.begin = 10 * kMillisecond;
    spec.end = 20 * kMillisecond;
    Bench bench({spec});
    bench.run(5 * kMillisecond);
    const double volts = bench.node->board().signal(pic::kBatteryVoltage);
    CHECK(bench.node->board().signal(pic::kBatteryLow) == 0);
    bench.run(15 * kMillisecond);
    CHECK(bench.node->board().signal(pic::kBatteryVoltage) == Approx(volts - 0.9));
    CHECK(bench.node->board().signal(pic::kBatteryLow) == 1);
    const std::vector<Message> changed{
        {16 * kMillisecond, pic::PicNode::kWorld, cosim::Signal{pic::kBatteryVoltage, 3.9}}};
    bench.node->advance(17 * kMillisecond, changed, bench.out);
    CHECK(bench.node->board().signal(pic::kBatteryVoltage) == Approx(3.0));
    bench.run(25 * kMillisecond);
    CHECK(bench.node->board().signal(pic::kBatteryVoltage) == Approx(3.9));
    CHECK(bench.node->board().signal(pic::kBatteryLow) == 0);
}

TEST_CASE("what held in the run of a saved state ends in a run without it, and goes on in one with it") {
    FaultSpec sag = board_fault("sag").set("volts", 0.9);
    sag.begin = 10 * kMillisecond;
    sag.end = 20 * kMillisecond;
    FaultSpec profile = board_fault("battery").set("profile", "0 s 3.6 V, 5 ms 3.5 V");
    profile.begin = 5 * kMillisecond;
    FaultSpec stall = board_fault("wheel_stall").set("motor", "left");
    stall.begin = 12 * kMillisecond;
    sag.name = "sag";
    profile.name = "profile";
    stall.name = "stall";
    Bench bench({sag, profile, stall});
    bench.run(15 * kMillisecond);
    const double volts = bench.node->board().signal(pic::kBatteryVoltage);
    CHECK(volts == Approx(2.6));
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    bench.node->state(writer);
    const auto loaded = [&](const std::vector<FaultSpec>& specs) {
        Bench other(specs);
        StateReader reader(bytes);
        other.node->state(reader);
        reader.end();
        other.run(16 * kMillisecond);
        return other.node->board().signal(pic::kBatteryVoltage);
    };
    CHECK(loaded({sag, profile, stall}) == Approx(2.6));
    CHECK(loaded({}) == Approx(3.9));
    CHECK(loaded({sag}) == Approx(3.0));
    CHECK(loaded({stall}) == Approx(3.9));
}

TEST_CASE("an interrupt out of nowhere is served") {
    const Time at = 20 * kMillisecond + 400 * cosim::kMicrosecond;
    Bench bench({once(board_fault("interrupt"), at).set("vector", "T1")}), sound({});
    bench.run(kEnd);
    sound.run(kEnd);
    CHECK(bench.toggles().size() == sound.toggles().size() + 1);
    const std::vector<Time> toggles = bench.toggles();
    CHECK(std::any_of(toggles.begin(), toggles.end(),
                      [&](Time t) { return t > at && t < at + 5 * cosim::kMicrosecond; }));
}

TEST_CASE("what a fault cannot do is refused with its place") {
    const auto fails = [](const FaultSpec& spec) {
        CHECK_THROWS_WITH(Bench({spec}), Catch::Contains("fault fault on board"));
    };
    fails(board_fault("reset").set("pc", "0x201"));
    fails(board_fault("reset").set("pc", "nowhere"));
    fails(board_fault("flip").set("space", "register").set("symbol", "U9STA"));
    fails(board_fault("flip").set("address", 0x100));
    fails(board_fault("flip").set("space", "ram").set("bit", 16));
    fails(board_fault("interrupt").set("vector", "U9RX"));
    fails(board_fault("nonsense"));
}

TEST_CASE("faults do not depend on how time is granted, skipped or translated") {
    RandomStream random(8, "cuts");
    for (int i = 0; i < 12; ++i) {
        std::vector<FaultSpec> specs;
        const auto add = [&](FaultSpec spec) {
            spec.name += std::to_string(specs.size());
            spec.begin = drawn(random, 0, kEnd / 2);
            if (random.below(2) == 0) spec.end = spec.begin + drawn(random, kMillisecond, kEnd / 2);
            if (random.below(2) == 0) spec.period = drawn(random, kMillisecond, 10 * kMillisecond);
            spec.probability = random.below(2) == 0 ? 1.0 : 0.5;
            specs.push_back(spec);
        };
        for (int n = 0; n < 5; ++n) {
            switch (random.below(8)) {
            case 0:
                add(board_fault("reset").set("cause", "watchdog"));
                break;
            case 1:
                add(board_fault("hang").set("duration", random.uniform() * 5e-3));
                break;
            case 2:
                add(board_fault("flip"));
                break;
            case 3:
                add(board_fault("clock").set("ppm", 5e4 * random.uniform()).set("drift", -2e4));
                break;
            case 4:
                add(board_fault("adc_noise").set("channel", 8).set("sigma", 0.1));
                break;
            case 5:
                add(board_fault("wheel_stall").set("motor", "left"));
                break;
            case 6:
                add(board_fault("hang").set("duration", 3e-4).set("pc", "0x204").set("nth", 3));
                break;
            default:
                add(board_fault("interrupt").set("vector", "T1"));
                break;
            }
        }
        const auto run = [&](bool skip, bool cut) {
            Bench bench(specs, skip);
            if (!cut) bench.run(kEnd);
            for (const Time until :
                 cut ? tests::random_cuts(random, 2 * kMillisecond, kEnd) : std::vector<Time>{})
                bench.run(until);
            // Ports need not keep order among each other.
            std::stable_sort(bench.out.begin(), bench.out.end(),
                             [](const Message& a, const Message& b) { return a.port < b.port; });
            return std::pair(bench.out, bench.node->finish());
        };
        const auto whole = run(true, false);
        CHECK(run(true, true) == whole);
        chip::set_translation(i % 2 == 0, 1);
        const auto executed = run(false, true);
        chip::set_translation(true);
        CHECK(executed.first == whole.first);
        CHECK(nlohmann::json::parse(executed.second).at("faults") ==
              nlohmann::json::parse(whole.second).at("faults"));
    }
}
