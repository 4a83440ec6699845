// CAN1 and CAN2 of the 30F: frames' lengths, modes, filters, error counters, two chips on a bus.

#include "base/random.h"
#include "emu/dspic/core/sfr_space.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

#include <functional>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

CanFrame draw(RandomStream& random) {
    CanFrame frame;
    frame.extended = random.below(2);
    frame.id = static_cast<std::uint32_t>(random.below(frame.extended ? 1u << 29 : 1u << 11));
    frame.remote = random.below(5) == 0;
    frame.length = static_cast<std::uint8_t>(random.below(9));
    if (!frame.remote)
        for (int i = 0; i < frame.length; ++i)
            frame.data[static_cast<std::size_t>(i)] = static_cast<std::uint8_t>(random.below(256));
    return frame;
}

std::string binary(std::uint32_t value, int bits) {
    std::string text;
    while (bits-- > 0)
        text += value >> bits & 1 ? '1' : '0';
    return text;
}

/// By the text of the specification: fields as characters, division of polynomials, stuffing by search.
int reference_bits(const CanFrame& frame) {
    std::string bits = "0";
    if (frame.extended)
        bits += binary(frame.id >> 18, 11) + "11" + binary(frame.id & 0x3FFFF, 18);
    else
        bits += binary(frame.id, 11);
    bits += (frame.remote ? "100" : "000") + binary(frame.length, 4);
    for (int i = 0; i < frame.length && !frame.remote; ++i)
        bits += binary(frame.data[static_cast<std::size_t>(i)], 8);
    const std::string divisor = "1100010110011001";
    std::string rest = bits + std::string(15, '0');
    for (std::size_t i = 0; i < bits.size(); ++i)
        if (rest[i] == '1')
            for (std::size_t j = 0; j < divisor.size(); ++j)
                rest[i + j] = rest[i + j] == divisor[j] ? '0' : '1';
    bits += rest.substr(bits.size());
    for (std::size_t at = 0;
         (at = std::min(bits.find("00000", at), bits.find("11111", at))) != std::string::npos;) {
        bits.insert(at + 5, 1, bits[at] == '0' ? '1' : '0');
        at += 5;
    }
    return static_cast<int>(bits.size()) + 1 + 2 + 7;
}

/// Runs of five overlap a stuffed bit's own run only from that bit on, as find() from there has it.
struct CanPins : Pins30 {
    std::vector<CanFrame> sent;
    std::vector<Cycle> acknowledged_at;
    std::function<CanOutcome(const CanFrame&, Cycle)> bus;
    CanOutcome can_sent(int, const CanFrame& frame, Cycle now) override {
        sent.push_back(frame);
        acknowledged_at.push_back(now);
        return bus ? bus(frame, now) : CanOutcome::NotAcknowledged;
    }
};

struct CanBench {
    CanPins pins;
    Chip chip{dspic30f6014a(), pins, ChipOptions{.fosc = std::uint16_t{0xFFE6}}};
    std::map<std::string, std::uint32_t> symbols;

    explicit CanBench(const std::string& more) {
        AssembleOptions options;
        for (const RegisterInfo& info : dspic30f6014a().registers)
            options.predefined[std::string(info.name)] = info.address;
        // 16 quanta of 2 cycles: 32 cycles a bit.
        const Program program = assemble(R"(
        goto main
        .org 0x4a
        .pword can1
        .org 0x200
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        clr C1CFG1
        mov #0x03ac, w0                 ; PRSEG 5, SEG1PH 6, SEG2PH 4
        mov w0, C1CFG2
        mov #0x0c00, w0                 ; FCAN = FCY, still configuration mode
        mov w0, C1CTRL
)" + more + R"(
ready:  repeat #0x3ff
        nop
        bra ready
can1:   bclr IFS1, #11
        inc 0x1000
        retfie
)",
                                         options);
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        symbols = program.symbols;
        chip.power_on();
    }
    Cycle run_to(const std::string& label) {
        chip.set_stops({symbols.at(label)});
        chip.run_until(chip.now() + 100 * cosim::kMillisecond);
        chip.set_stops({});
        if (!chip.stopped_at()) throw std::runtime_error("label not reached: " + label);
        return chip.cycle();
    }
    void go(Cycle cycle) { chip.run_until(chip.clock().time_of(cycle)); }
    int reg(std::string_view name) const { return chip.peek(name); }
};

constexpr Cycle kBit = 32;

std::string set(int value, const std::string& name) {
    return "        mov #" + std::to_string(value & 0xFFFF) + ", w0\n        mov w0, " + name + "\n";
}

/// The registers of transmit buffer 0.
std::string load(const CanFrame& frame) {
    const std::uint32_t standard = frame.extended ? frame.id >> 18 : frame.id;
    const int sid = static_cast<int>((standard >> 6) << 11 | (standard & 0x3F) << 2);
    const int eid =
        frame.extended ? static_cast<int>((frame.id >> 14 & 15) << 12 | (frame.id >> 6 & 0xFF)) : 0;
    const int dlc = (frame.extended ? static_cast<int>(frame.id & 0x3F) << 10 : 0) | frame.length << 3;
    std::string text = set(sid | (frame.extended ? 1
                                  : frame.remote ? 2
                                                 : 0),
                           "C1TX0SID") +
                       set(eid, "C1TX0EID") +
                       set(dlc | (frame.extended && frame.remote ? 0x200 : 0), "C1TX0DLC");
    for (std::size_t i = 0; i < 4; ++i)
        text += set(frame.data[2 * i] | frame.data[2 * i + 1] << 8, "C1TX0B" + std::to_string(i + 1));
    return text;
}

/// What receive buffer `n` holds.
CanFrame received(const Chip& chip, const std::string& n) {
    const auto reg = [&](const std::string& name) {
        return static_cast<unsigned>(chip.peek("C1RX" + n + name));
    };
    CanFrame frame;
    frame.extended = reg("SID") & 1;
    frame.id = reg("SID") >> 2 & 0x7FF;
    if (frame.extended) frame.id = frame.id << 18 | reg("EID") << 6 | reg("DLC") >> 10;
    frame.remote = frame.extended ? reg("DLC") & 0x200 : reg("SID") & 2;
    frame.length = reg("DLC") & 15;
    for (std::size_t i = 0; i < frame.length && !frame.remote; ++i)
        frame.data[i] = static_cast<std::uint8_t>(reg("B" + std::to_string(i / 2 + 1)) >> (i % 2 ? 8 : 0));
    return frame;
}

}  // namespace

TEST_CASE("a frame is as long as its bits and stuff bits (CAN 2.0)") {
    RandomStream random(21, "frames");
    for (int i = 0; i < 500; ++i) {
        CanFrame frame = draw(random);
        if (i % 5 == 0) frame.data.fill(i % 2 ? 0x00 : 0xFF);
        if (frame.remote) frame.data.fill(0);
        CHECK(can_bits(frame) == reference_bits(frame));
    }
    CHECK(can_bits({.id = 0x555, .length = 8, .data = {0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55}}) >=
          108);
}

TEST_CASE("loopback: what is sent comes into RXB0 to the cycle at the frame's end (DS70070 23.6)") {
    RandomStream random(4, "frames");
    for (int i = 0; i < 6; ++i) {
        const CanFrame frame = draw(random);
        CanBench bench(load(frame) + R"(
        mov #0x0a00, w0                 ; loopback
        mov w0, C1CTRL
        bset C1INTE, #0
        bset C1INTE, #2
        bset IEC1, #11
        bset C1TX0CON, #3
sent:
)");
        const Cycle end = bench.run_to("sent") + kBit * static_cast<Cycle>(can_bits(frame));
        CHECK((bench.reg("C1CTRL") & 0xE0) == 0x40);
        bench.go(end);
        CHECK((bench.reg("C1INTF") & 0xFF) == 0);
        CHECK((bench.reg("C1TX0CON") & 8) == 8);
        bench.go(end + 1);
        CHECK((bench.reg("C1INTF") & 0xFF) == 0x05);
        CHECK((bench.reg("C1CTRL") & 0xE) == 0xC);  // ICODE: RXB0
        CHECK(bench.reg("C1TX0CON") == 0);
        CHECK((bench.reg("C1RX0CON") & 0x80) == 0x80);
        CHECK(received(bench.chip, "0") == frame);
        bench.go(end + 40);
        CHECK(bench.chip.peek_data(0x1000) == 1);
        CHECK(bench.pins.sent.empty());
    }
}

TEST_CASE("the buffer of the highest priority goes first, the highest number among equals (DS70070 23.8)") {
    CanBench bench(R"(
        mov #4, w0
        mov w0, C1TX0SID
        mov #8, w0
        mov w0, C1TX1SID
        mov #12, w0
        mov w0, C1TX2SID
        mov #0x0a00, w0
        mov w0, C1CTRL
        mov #1, w0
        mov w0, C1TX1CON
        clr C1CTRL
        mov #0x0800, w0                 ; Normal, after 11 bits
        mov w0, C1CTRL
        bset C1TX0CON, #3
        bset C1TX1CON, #3
        bset C1TX2CON, #3
)");
    bench.pins.bus = [](const CanFrame&, Cycle) { return CanOutcome::Acknowledged; };
    bench.go(20'000);
    REQUIRE(bench.pins.sent.size() == 3);
    CHECK(bench.pins.sent[0].id == 2);
    CHECK(bench.pins.sent[1].id == 3);
    CHECK(bench.pins.sent[2].id == 1);
    // Three bits of intermission lie between.
    CHECK(bench.pins.acknowledged_at[1] - bench.pins.acknowledged_at[0] ==
          kBit * static_cast<Cycle>(3 + can_bits(bench.pins.sent[1])));
}

TEST_CASE("alone on the bus a sender is error passive after 16 tries and goes on; a broken bus puts it off") {
    const std::string program = set(0x0800, "C1CTRL") + set(4, "C1TX0SID") + R"(
wait:   mov C1CTRL, w1
        and #0xe0, w1
        bra nz, wait
        bset C1INTE, #5
        bset C1TX0CON, #3
)";
    CanBench alone(program);
    alone.go(100'000);
    CHECK(alone.pins.sent.size() > 40);
    CHECK(alone.reg("C1EC") == 0x8000);
    CHECK((alone.reg("C1INTF") & 0x3F20) == 0x1520);  // TXBP, TXWARN, EWARN, ERRIF
    CHECK((alone.reg("C1TX0CON") & 0x18) == 0x18);
    alone.pins.bus = [](const CanFrame&, Cycle) { return CanOutcome::Acknowledged; };
    alone.go(105'000);
    CHECK((alone.reg("C1TX0CON") & 0x18) == 0);
    CHECK(alone.reg("C1EC") == 0x7F00);

    CanBench broken(program);
    broken.pins.bus = [](const CanFrame&, Cycle) { return CanOutcome::BitError; };
    broken.go(80'000);
    CHECK(broken.pins.sent.size() == 32);
    CHECK((broken.reg("C1INTF") & 0x2000) == 0x2000);  // TXBO
    broken.go(broken.pins.acknowledged_at.back() + 128 * 11 * kBit + 4000);
    CHECK(broken.pins.sent.size() > 32);  // recovered after 128 times 11 bits
}

TEST_CASE("filters and masks let through what they should, drawn against the rule (DS70070 23.7)") {
    RandomStream random(8, "filters");
    for (int i = 0; i < 4; ++i) {
        std::array<std::uint32_t, 6> filter{};
        std::array<bool, 6> extended{};
        std::array<std::uint32_t, 2> mask{};
        std::string text;
        const auto registers = [&](const std::string& name, std::uint32_t id, bool low) {
            text += set(static_cast<int>((id >> 18) << 2 | (low ? 1u : 0u)), name + "SID") +
                    set(static_cast<int>(id >> 6 & 0xFFF), name + "EIDH") +
                    set(static_cast<int>((id & 0x3F) << 10), name + "EIDL");
        };
        for (std::size_t f = 0; f < 6; ++f) {
            filter[f] = static_cast<std::uint32_t>(random.below(1u << 29));
            extended[f] = random.below(2);
            registers("C1RXF" + std::to_string(f), filter[f], extended[f]);
        }
        for (std::size_t m = 0; m < 2; ++m) {
            mask[m] =
                3u << 24 | 1u << static_cast<int>(random.below(18));  // a few bits: about every eighth fits
            registers("C1RXM" + std::to_string(m), mask[m], true);
        }
        CanBench bench(text + set(0x0800, "C1CTRL"));
        bench.run_to("ready");
        Cycle at = 5000;
        int hits = 0;
        for (int k = 0; k < 60; ++k, at += 10'000) {
            CanFrame frame = draw(random);
            bench.go(at);
            CHECK(bench.chip.can_receive(1, frame));
            const std::uint32_t id = frame.extended ? frame.id : frame.id << 18;
            int first = -1;
            for (std::size_t f = 0; f < 6 && first < 0; ++f) {
                std::uint32_t cares = mask[f < 2 ? 0 : 1];
                if (!frame.extended) cares &= 0x1FFC0000;
                if (extended[f] == frame.extended && ((filter[f] ^ id) & cares) == 0)
                    first = static_cast<int>(f);
            }
            const bool in0 = bench.reg("C1RX0CON") & 0x80, in1 = bench.reg("C1RX1CON") & 0x80;
            CHECK(in0 == (first == 0 || first == 1));
            CHECK(in1 == (first > 1));
            if (in0) CHECK(received(bench.chip, "0") == frame);
            if (in0) CHECK((bench.reg("C1RX0CON") & 1) == first);
            if (in1) CHECK(received(bench.chip, "1") == frame);
            if (in1) CHECK((bench.reg("C1RX1CON") & 7) == first);
            hits += in0 || in1;
            auto inside = bench.chip.inside();
            inside.sfr.write(0x38E, 0, 0xFFFF);  // the program gives both back
            inside.sfr.write(0x37E, 0, 0xFFFF);
        }
        CHECK(hits > 5);
    }
}

TEST_CASE("RXB0 overflows into RXB1 with DBEN, else the frame is lost with RXB0OVFL") {
    for (const int dben : {0, 4}) {
        CAPTURE(dben);
        CanBench bench(set(dben, "C1RX0CON") + set(0x0800, "C1CTRL"));  // masks 0: everything passes
        bench.run_to("ready");
        for (std::uint32_t i = 0; i < 3; ++i) {
            bench.go(5000 + 5000 * i);
            bench.chip.can_receive(1, {.id = 0x100 + i, .length = 1, .data = {static_cast<std::uint8_t>(i)}});
        }
        CHECK(received(bench.chip, "0").id == 0x100);
        CHECK(((bench.reg("C1RX1CON") & 0x80) != 0) == (dben != 0));
        if (dben) CHECK(received(bench.chip, "1").id == 0x101);
        CHECK((bench.reg("C1INTF") & 0xC020) == 0x8020);
    }
}

TEST_CASE("configuration mode alone takes filters and timing; Disable and Sleep wake by the bus") {
    CanBench bench(set(0x0900, "C1CTRL") + set(0x55, "C1CFG1") + set(0x7FC, "C1RXF0SID") + R"(
        bset C1INTE, #6
        bset IEC1, #11
        mov #0x0200, w0
        pwrsav #0
woken:
)");
    bench.go(5000);
    CHECK((bench.reg("C1CTRL") & 0xE0) == 0x20);
    CHECK(bench.reg("C1CFG1") == 0);
    CHECK(bench.reg("C1RXF0SID") == 0);
    CHECK_FALSE(bench.chip.can_receive(1, {.id = 1}));
    bench.go(9000);
    CHECK((bench.reg("C1INTF") & 0x40) == 0x40);
    CHECK(bench.chip.peek_data(0x1000) == 1);
}

TEST_CASE("two chips on a bus: an echo comes back, and both saved in the middle go on alike") {
    const std::string echo = set(0x0800, "C1CTRL") + R"(
wait:   btss C1INTF, #0
        bra wait
        bclr C1INTF, #0
        mov C1RX0B1, w1
        com w1, w1
        mov w1, C1TX0B1
        mov #0x10, w0
        mov w0, C1TX0DLC
        mov #0x1010, w0
        mov w0, C1TX0SID
        bclr C1RX0CON, #7
        bset C1TX0CON, #3
        bra wait
)";
    const std::string ask =
        set(0x0800, "C1CTRL") + load({.id = 0x321, .length = 2, .data = {0x34, 0x12}}) + R"(
        bset C1TX0CON, #3
)";
    CanBench left(ask), right(echo);
    const auto connect = [](CanBench& from, CanBench& to) {
        from.pins.bus = [&from, &to](const CanFrame& frame, Cycle at) {
            to.chip.run_until(from.chip.clock().time_of(at));
            return to.chip.can_receive(1, frame) ? CanOutcome::Acknowledged : CanOutcome::NotAcknowledged;
        };
    };
    connect(left, right);
    connect(right, left);
    left.go(9000);
    CHECK((left.reg("C1INTF") & 4) == 4);
    CHECK(left.reg("C1EC") == 0);
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    right.chip.state(writer);
    CanBench again(echo);
    StateReader reader(bytes);
    again.chip.state(reader);
    std::vector<CanFrame> repeated;
    again.pins.bus = [&](const CanFrame& frame, Cycle) {
        repeated.push_back(frame);
        return CanOutcome::Acknowledged;
    };
    again.go(20'000);
    right.go(20'000);
    CHECK(received(left.chip, "0") == CanFrame{.id = 0x84, .length = 2, .data = {0xCB, 0xED}});
    REQUIRE(repeated.size() == 1);
    CHECK(repeated[0].data == right.pins.sent.back().data);
    CHECK((right.reg("C1INTF") & 4) == 4);
}
