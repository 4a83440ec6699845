// CAN1 and CAN2 of the 30F: frames' lengths, modes, filters, error counters, two chips on a bus.

#include "base/random.h"
#include "cosim/faults/kinds/kind_table.h"
#include "emu/dspic/machine/sfr_space.h"
#include "tests/can/can_reference.h"
#include "tests/dspic/peripherals/can_bus_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using tests::draw_frame, tests::reference_bits;

namespace {

struct CanBench {
    CanPins pins;
    Chip chip{dspic30f6014a(), pins, ChipOptions{.fosc = std::uint16_t{0xFFE6}}};
    std::map<std::string, std::uint32_t> symbols;

    explicit CanBench(const std::string& more, bool wired = true) : pins(wired) {
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

cosim::Time time_of(const CanBench& bench, Cycle cycle) {
    return bench.chip.clock().time_of(cycle);
}
/// 16 quanta as the chips have it.
cosim::Time bit_time(const CanBench& bench) {
    return time_of(bench, 1000 * kBit) / 1000;
}

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
        CanFrame frame = draw_frame(random);
        if (i % 5 == 0) frame.data.fill(i % 2 ? 0x00 : 0xFF);
        if (frame.remote) frame.data.fill(0);
        CHECK(can_bits(frame) == reference_bits(frame));
    }
    CHECK(can_bits(CanFrame{
              .id = 0x555, .length = 8, .data = {0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55, 0x55}}) >= 108);
}

TEST_CASE("loopback: what is sent comes into RXB0 to the cycle at the frame's end (DS70070 23.6)") {
    RandomStream random(4, "frames");
    for (int i = 0; i < 6; ++i) {
        const CanFrame frame = draw_frame(random);
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
        CHECK(bench.pins.to_bus.empty());  // the bus hears nothing of it
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
    CanBusBench bus({{&bench.chip, &bench.pins}});
    bus.peer_joins(0, bit_time(bench));
    bus.run_until(time_of(bench, 20'000));
    const auto sent = bus.told(0, CanKind::Sent);
    REQUIRE(sent.size() == 3);
    CHECK(sent[0].message.id == 2);
    CHECK(sent[1].message.id == 3);
    CHECK(sent[2].message.id == 1);
    // Three bits of intermission lie between.
    const cosim::Time between = sent[1].message.start - sent[0].time;
    CHECK(std::abs(between - 3 * bit_time(bench)) < bit_time(bench) / 100);
}

TEST_CASE("alone a sender is error passive after 16 tries and goes on, on a bus until somebody comes") {
    const std::string program = set(0x0800, "C1CTRL") + set(4, "C1TX0SID") + R"(
wait:   mov C1CTRL, w1
        and #0xe0, w1
        bra nz, wait
        bset C1INTE, #5
        bset C1TX0CON, #3
)";
    for (const bool wired : {false, true}) {
        CAPTURE(wired);
        CanBench alone(program, wired);
        CanBusBench bus({{&alone.chip, &alone.pins}});
        bus.run_until(time_of(alone, 100'000));
        CHECK(alone.reg("C1EC") == 0x8000);
        CHECK((alone.reg("C1INTF") & 0x3F20) == 0x1520);  // TXBP, TXWARN, EWARN, ERRIF
        CHECK((alone.reg("C1TX0CON") & 0x18) == 0x18);
        CHECK((bus.told(0, CanKind::Error).size() > 30) == wired);
        bus.peer_joins(time_of(alone, 100'001), bit_time(alone));
        bus.run_until(time_of(alone, 110'000));
        CHECK((alone.reg("C1TX0CON") & 0x18) == (wired ? 0 : 0x18));
        CHECK(alone.reg("C1EC") == (wired ? 0x7F00 : 0x8000));
    }
}

TEST_CASE("frames spoilt 32 times put a sender off the bus, until 128 times 11 bits have been idle") {
    CanBench bench(set(0x0800, "C1CTRL") + set(4, "C1TX0SID") + R"(
wait:   mov C1CTRL, w1
        and #0xe0, w1
        bra nz, wait
        bset C1TX0CON, #3
)");
    cosim::FaultSpec spec;
    spec.link = spec.node = "can";
    spec.kind = "flip";
    spec.count = 32;
    spec.set("bit", 3);
    CanBusBench bus({{&bench.chip, &bench.pins}},
                    {{spec, cosim::Trigger(spec, cosim::fault_stream(spec, 1, 0))}});
    bus.peer_joins(0, bit_time(bench));
    bus.run_until(time_of(bench, 80'000));
    CHECK((bench.reg("C1INTF") & 0x2000) == 0x2000);  // TXBO
    CHECK(bus.told(0, CanKind::Error).size() == 32);
    CHECK(bus.told(0, CanKind::Sent).empty());
    bus.run_until(time_of(bench, 130'000));
    CHECK(bus.told(0, CanKind::Recovered).size() == 1);
    CHECK(bus.told(0, CanKind::Sent).size() == 1);
    CHECK(bench.reg("C1EC") == 0);
    CHECK((bench.reg("C1TX0CON") & 0x18) == 0);
}

TEST_CASE("TXREQ taken back: TXABT, unless the frame is on the wire, another mode waits for it") {
    const std::string program = set(0x0800, "C1CTRL") + set(4, "C1TX0SID") + R"(
wait:   mov C1CTRL, w1
        and #0xe0, w1
        bra nz, wait
        repeat #0xfff
        nop
        bset C1TX0CON, #3
        repeat #0xff
        nop
asked:  bclr C1TX0CON, #3
        nop
)" + set(0x0900, "C1CTRL");
    for (const bool first : {false, true}) {  // somebody else was before it
        CAPTURE(first);
        CanBench bench(program);
        CanBusBench bus({{&bench.chip, &bench.pins}});
        bus.peer_joins(0, bit_time(bench));
        if (first) bus.peer_sends(time_of(bench, 4200), {.id = 1, .length = 8});
        bus.run_until(time_of(bench, 20'000));
        CHECK((bench.reg("C1TX0CON") & 0x78) == (first ? 0x40 : 0));
        CHECK(bus.told(0, CanKind::Sent).size() == (first ? 0 : 1));
        CHECK((bench.reg("C1CTRL") & 0xE0) == 0x20);  // Disable
    }
}

TEST_CASE("who loses arbitration shows TXLARB and is sent behind the winner") {
    const std::string program = set(0x0800, "C1CTRL") + set(0x2004, "C1TX0SID") + R"(
wait:   mov C1CTRL, w1
        and #0xe0, w1
        bra nz, wait
        repeat #0x7ff
        nop
asks:   bset C1TX0CON, #3
)";
    CanBench bench(program), twin(program);
    const cosim::Time bit = bit_time(bench);
    // The peer's request comes in the same bit as the chip's.
    const Cycle asks = twin.run_to("asks");
    CanBusBench bus({{&bench.chip, &bench.pins}});
    bus.peer_joins(0, bit);
    const CanFrame winner{.id = 0x80, .length = 1, .data = {9}};
    bus.peer_sends(time_of(bench, asks + 10), winner);
    const Cycle end = asks + kBit * static_cast<Cycle>(can_bits(winner));
    bus.run_until(time_of(bench, end + 10));
    CHECK((bench.reg("C1TX0CON") & 0x28) == 0x28);  // TXLARB, TXREQ
    CHECK(received(bench.chip, "0") == winner);
    bus.run_until(time_of(bench, end + 100 * kBit));
    CHECK(bus.told(0, CanKind::Sent).size() == 1);
    CHECK((bench.reg("C1TX0CON") & 0x08) == 0);
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
            CanFrame frame = draw_frame(random);
            bench.go(at);
            receive(bench.chip, frame);
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
            receive(bench.chip, {.id = 0x100 + i, .length = 1, .data = {static_cast<std::uint8_t>(i)}});
        }
        CHECK(received(bench.chip, "0").id == 0x100);
        CHECK(((bench.reg("C1RX1CON") & 0x80) != 0) == (dben != 0));
        if (dben) CHECK(received(bench.chip, "1").id == 0x101);
        CHECK((bench.reg("C1INTF") & 0xC020) == 0x8020);
    }
}

TEST_CASE("configuration mode alone takes filters and timing, Disable and Sleep wake by the bus") {
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
    REQUIRE_FALSE(bench.pins.to_bus.empty());
    CHECK(bench.pins.to_bus.back().kind == CanKind::Watch);
    CanMessage stirs;
    stirs.kind = CanKind::Wake;
    bench.chip.can_news(1, stirs);
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
    CanBench left(ask), right(echo), again(echo);
    CanBusBench bus({{&left.chip, &left.pins}, {&right.chip, &right.pins}});
    bus.run_until(time_of(left, 3500));
    CHECK((left.reg("C1INTF") & 4) == 4);
    CHECK(left.reg("C1EC") == 0);
    const auto taken = bus.told(1, CanKind::Received);
    REQUIRE(taken.size() == 1);
    // Saved while its answer is on the wire.
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    right.chip.state(writer);
    StateReader reader(bytes);
    again.chip.state(reader);
    bus.run_until(time_of(left, 20'000));
    CHECK(received(left.chip, "0") == CanFrame{.id = 0x84, .length = 2, .data = {0xCB, 0xED}});
    const auto answered = bus.told(1, CanKind::Sent);
    REQUIRE(answered.size() == 1);
    again.chip.run_until(answered[0].time);
    again.chip.can_news(1, answered[0].message);
    again.chip.run_until(right.chip.now());
    CHECK((right.reg("C1INTF") & 4) == 4);
    // PORTx's storage is what the last look at the pins saw.
    CHECK(right.reg("PORTF") == again.reg("PORTF"));
    std::vector<std::uint8_t> one, other;
    StateWriter of_right(one), of_again(other);
    right.chip.state(of_right);
    again.chip.state(of_again);
    CHECK(one == other);
}
