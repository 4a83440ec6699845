// The composed chip, with small programs of its own: times at the pins, lookahead, reports, clock switching.

#include "emu/dspic/chip/chip.h"

#include "base/random.h"
#include "emu/dspic/assembler/assembler.h"

#include <catch2/catch.hpp>

#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::dspic;
using cosim::Time;

namespace {

constexpr std::uint16_t kFoscCrystalX8 = 0xFFE6;
constexpr double kTcy = 1e12 / 14'745'600.0;

struct Recorder : Pins {
    struct Edge {
        Time at;
        std::uint16_t levels;
    };
    struct Sent {
        Time handed_out;  ///< the chip's time when it reported
        Time stamp;       ///< of the message
    };
    const Chip* chip = nullptr;
    std::vector<Edge> port_d;
    std::vector<cosim::UartFrame> frames;
    std::vector<cosim::I2cPhase> phases;

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t, Cycle now) override {
        if (port == PortLetter::D) port_d.push_back({chip->clock().time_of(now), levels});
    }
    std::uint16_t levels(PortLetter, Cycle) override { return 0; }
    double analog(int, Cycle) override { return 0.5; }
    void uart_sent(int, const cosim::UartFrame& frame) override { frames.push_back(frame); }
    void i2c_phase(int, const cosim::I2cPhase& phase) override { phases.push_back(phase); }
};

struct Bench {
    Recorder pins;
    Chip chip;

    explicit Bench(const std::string& source, std::uint16_t fosc = kFoscCrystalX8)
        : chip(dspic30f6014a(), pins, {.fosc = fosc}) {
        pins.chip = &chip;
        AssembleOptions options;
        for (const RegisterInfo& info : dspic30f6014a().registers)
            options.predefined[std::string(info.name)] = info.address;
        const Program program = assemble("        goto main\n" + source, options);
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        symbols = program.symbols;
        chip.power_on();
    }
    std::map<std::string, std::uint32_t> symbols;
};

const std::string kBlink = R"(
        .org 0x001A
        .pword isr
        .org 0x100
main:   mov #0x27f0, w0
        mov w0, SPLIM
        clr TRISD
        mov #999, w0
        mov w0, PR1
        bset IEC0, #3
        mov #0x8000, w0
        mov w0, T1CON
wait:   bra wait
isr:    bclr IFS0, #3
        btg LATD, #0
        retfie
)";

const std::string kEcho = R"(
        .org 0x100
main:   mov #7, w0
        mov w0, U2BRG
        mov #0x8000, w0
        mov w0, U2MODE
        mov #0x0400, w0
        mov w0, U2STA
wait:   btss U2STA, #0
        bra wait
        mov U2RXREG, w1
        mov w1, U2TXREG
        bra wait
)";

}  // namespace

TEST_CASE("a timer interrupt toggles a pin at exact times, however the run is cut") {
    std::vector<Time> reference;
    for (const int variant : {0, 1}) {
        Bench bench(kBlink);
        RandomStream random(7, "cuts");
        const Time end = cosim::kMillisecond;
        if (variant == 1)
            for (Time time = 0; time < end; time += static_cast<Time>(random.below(3'000'000)))
                bench.chip.run_until(time);
        bench.chip.run_until(end);
        std::vector<Time> edges;
        for (const auto& edge : bench.pins.port_d)
            edges.push_back(edge.at);
        REQUIRE(edges.size() > 10);
        for (std::size_t i = 2; i < edges.size(); ++i)
            CHECK(static_cast<double>(edges[i] - edges[i - 1]) == Approx(1000 * kTcy).margin(kTcy + 1.0));
        if (variant == 0) reference = edges;
        CHECK(edges == reference);
        CHECK(bench.chip.now() == end);
    }
}

TEST_CASE("an echo answers each byte, never earlier than the chip reported") {
    Bench bench(kEcho);
    Chip& chip = bench.chip;
    const Time bit = cosim::from_seconds(1.0 / 115200.0);
    RandomStream random(1, "gaps");
    Time start = cosim::kMillisecond;
    for (int i = 0; i < 20; ++i) {
        cosim::UartFrame frame;
        frame.start = start;
        frame.bit_period = bit;
        frame.data = static_cast<std::uint16_t>(random.below(256));
        const Time arrival = start + 9 * bit;
        while (chip.now() < arrival) {
            const Time promised = chip.earliest_uart_send(2, bit);
            const std::size_t before = bench.pins.frames.size();
            chip.run_until(std::min(arrival, chip.now() + static_cast<Time>(random.below(40'000'000)) + 1));
            for (std::size_t k = before; k < bench.pins.frames.size(); ++k) {
                const cosim::UartFrame& sent = bench.pins.frames[k];
                CHECK(sent.start + 9 * sent.bit_period >= promised);
            }
        }
        chip.uart_receive(2, frame);
        chip.run_until(start + 9 * bit + bit / 2 + 3 * cosim::kMicrosecond);
        REQUIRE(chip.uart_begun(2));
        CHECK(*chip.uart_begun(2) > arrival + bit / 3);
        CHECK(*chip.uart_begun(2) < arrival + bit);
        chip.run_until(start + 22 * bit);
        REQUIRE(bench.pins.frames.size() == static_cast<std::size_t>(i + 1));
        CHECK(bench.pins.frames.back().data == frame.data);
        start += 25 * bit + static_cast<Time>(random.below(1'000'000'000));
    }
    CHECK(chip.uart_counters(2).received == 20);
    CHECK(chip.uart_counters(2).sent == 20);
    CHECK(chip.uart_enabled(2));
    CHECK_FALSE(chip.uart_enabled(1));
}

TEST_CASE("the first touch of an address without a register is reported by PC and direction, once") {
    Bench bench(R"(
        .org 0x100
main:   mov #3, w1
again:  mov w0, 0x7f0
        mov 0x7f2, w2
        dec w1, w1
        bra nz, again
wait:   bra wait
)");
    bench.chip.run_until(cosim::kMillisecond);
    const ChipReport report = bench.chip.report();
    REQUIRE(report.unmodelled.size() == 2);
    CHECK(report.unmodelled[0].name.empty());
    CHECK(report.unmodelled[0].address == 0x7F0);
    CHECK(report.unmodelled[0].pc == bench.symbols.at("again"));
    CHECK(report.unmodelled[0].write);
    CHECK(report.unmodelled[1].address == 0x7F2);
    CHECK(report.unmodelled[1].pc == bench.symbols.at("again") + 2);
    CHECK_FALSE(report.unmodelled[1].write);
    CHECK_THROWS_AS(bench.chip.peek("NOSUCH"), std::out_of_range);
}

TEST_CASE("stop addresses end a run before their instruction, MCLR starts over with EXTR set") {
    Bench bench(kBlink);
    Chip& chip = bench.chip;
    chip.stop_at(bench.symbols.at("isr"));
    chip.run_until(cosim::kSecond);
    REQUIRE(chip.stopped_at() == bench.symbols.at("isr"));
    CHECK(chip.pc() == bench.symbols.at("isr"));
    const Time first = chip.now();
    CHECK(first < 80 * cosim::kMicrosecond);
    CHECK(chip.peek("LATD") == 0);
    chip.run_until(cosim::kSecond);
    REQUIRE(chip.stopped_at());
    CHECK(static_cast<double>(chip.now() - first) == Approx(1000 * kTcy).margin(kTcy + 1.0));
    CHECK(chip.peek("LATD") == 1);

    chip.mclr();
    CHECK(chip.pc() == 0);
    CHECK((chip.peek("RCON") & 0x0083) == 0x0083);  // POR and BOR stay until software clears them
    CHECK(chip.peek("T1CON") == 0);
    CHECK(chip.peek("TRISD") == 0xFFFF);
    const ChipReport report = chip.report();
    REQUIRE(report.resets.size() == 2);
    CHECK(report.resets[0].cause == "POR");
    CHECK(report.resets[1].cause == "EXTR");
}

TEST_CASE("a clock switch changes the pace at once, and a run still ends at its time") {
    // Toggles a pin every 10 cycles; after 100 toggles switches from crystal x8 (14.7456 MHz) to FRC (1.8425
    // MHz).
    const std::string source = R"(
        .org 0x100
main:   clr TRISD
        mov #100, w1
fast:   btg LATD, #0
        repeat #4
        nop
        dec w1, w1
        bra nz, fast
        mov #OSCCON+1, w2
        mov.b #0x78, w3
        mov.b #0x9A, w4
        mov.b #0x01, w5
        mov.b w3, [w2]
        mov.b w4, [w2]
        mov.b w5, [w2]
        mov #OSCCON, w2
        mov.b #0x46, w3
        mov.b #0x57, w4
        mov.b w3, [w2]
        mov.b w4, [w2]
        mov.b w5, [w2]
slow:   btg LATD, #0
        repeat #4
        nop
        nop
        bra slow
)";
    std::vector<Time> reference;
    for (const int variant : {0, 1}) {
        Bench bench(source, 0x3F06);  // FCKSM = 00: switching allowed
        const Time end = 400 * cosim::kMicrosecond;
        if (variant == 1)
            for (Time time = 0; time < end; time += 1'234'567) {
                bench.chip.run_until(time);
                CHECK(bench.chip.now() == time);
            }
        bench.chip.run_until(end);
        std::vector<Time> edges;
        for (const auto& edge : bench.pins.port_d)
            edges.push_back(edge.at);
        REQUIRE(edges.size() > 130);
        CHECK(static_cast<double>(edges[50] - edges[49]) == Approx(10 * kTcy).margin(1.5));
        const std::size_t last = edges.size() - 1;
        CHECK(static_cast<double>(edges[last] - edges[last - 1]) == Approx(10e12 / (7.37e6 / 4)).margin(1.5));
        CHECK(edges.back() <= end + cosim::kMicrosecond);
        CHECK(edges.back() > end - 7 * cosim::kMicrosecond);
        if (variant == 0) reference = edges;
        CHECK(edges == reference);
        CHECK(bench.chip.peek("OSCCON") >> 12 == 1);
    }
}

TEST_CASE("Idle lets a timer run and wake the part, TSIDL and Sleep hold its count") {
    const auto [control, saving, wakes] = GENERATE(table<std::string, std::string, bool>({
        {"#0x8000", "#1", true},   // Idle
        {"#0xA000", "#1", false},  // Idle, TSIDL
        {"#0x8000", "#0", false},  // Sleep
    }));
    Bench bench(R"(
        .org 0x100
main:   clr TRISD
        mov #999, w0
        mov w0, PR1
        bset IEC0, #3
        bclr IPC0, #14          ; priority 0: wakes without a vector
        mov )" + control +
                R"(, w0
        mov w0, T1CON
        pwrsav )" +
                saving + R"(
        mov TMR1, w5
        bset LATD, #0
done:   bra done
)");
    bench.chip.run_until(cosim::kMillisecond);
    const auto drives = bench.pins.port_d;
    const bool woke = !drives.empty() && drives.back().levels == 1;
    CHECK(woke == wakes);
    if (woke) CHECK(static_cast<double>(drives.back().at) == Approx(1000 * kTcy).margin(25 * kTcy));
    const std::uint16_t count = bench.chip.peek("TMR1");
    bench.chip.run_until(2 * cosim::kMillisecond);
    if (!wakes) {
        CHECK(count < 5);
        CHECK(bench.chip.peek("TMR1") == count);
    }
}

TEST_CASE("an I2C start goes out when it was promised or later, and an answer moves the program on") {
    Bench bench(R"(
        .org 0x100
main:   mov #150, w0
        mov w0, I2CBRG
        mov #0x8000, w0
        mov w0, I2CCON
        bset I2CCON, #0
start:  btsc I2CCON, #0
        bra start
        mov #0xC0, w0
        mov w0, I2CTRN
sent:   btsc I2CSTAT, #14
        bra sent
        bset I2CCON, #2
stop:   btsc I2CCON, #2
        bra stop
        mov I2CSTAT, w5
done:   bra done
)");
    Chip& chip = bench.chip;
    Time promised = chip.earliest_i2c(1);
    while (bench.pins.phases.empty()) {
        promised = chip.earliest_i2c(1);
        chip.run_until(chip.now() + 500'000);
        REQUIRE(chip.now() < cosim::kMillisecond);
    }
    const cosim::I2cPhase start = bench.pins.phases[0];
    CHECK(start.kind == cosim::I2cPhaseKind::Start);
    CHECK(start.start >= promised);
    CHECK(chip.earliest_i2c(1) == cosim::kNever);
    const Time answered = start.start + 9 * start.clock_period;
    chip.run_until(answered);
    chip.i2c_answer(1, {.kind = cosim::I2cPhaseKind::Acknowledge, .ack = 1});
    chip.run_until(answered + 50 * cosim::kMicrosecond);
    REQUIRE(bench.pins.phases.size() == 2);
    CHECK(bench.pins.phases[1].kind == cosim::I2cPhaseKind::Stop);
    CHECK(bench.pins.phases[1].start > answered);
    CHECK(chip.pc() == bench.symbols.at("done"));
    CHECK((chip.peek("I2CSTAT") & 0x8018) == 0x0010);
}

TEST_CASE("a pause asked for at the pins ends a run there, and changes nothing else") {
    // Who answers only between runs is in time, however far each run was to go.
    struct Nobody : Recorder {
        Chip* master = nullptr;
        Time due = cosim::kNever;
        void i2c_phase(int unit, const cosim::I2cPhase& phase) override {
            Recorder::i2c_phase(unit, phase);
            if (phase.kind == cosim::I2cPhaseKind::Stop) return;
            due = i2c_ninth_clock_end(phase);
            master->pause_at(due);
        }
    };
    const auto run = [](Time step, std::vector<Time>& pauses) {
        Nobody pins;
        Chip chip(dspic30f6014a(), pins, {.fosc = kFoscCrystalX8});
        pins.chip = pins.master = &chip;
        AssembleOptions options;
        for (const RegisterInfo& info : dspic30f6014a().registers)
            options.predefined[std::string(info.name)] = info.address;
        const Program program = assemble(R"(
        goto main
        .org 0x100
main:   mov #150, w0
        mov w0, I2CBRG
        mov #0x8000, w0
        mov w0, I2CCON
again:  bset I2CCON, #0
start:  btsc I2CCON, #0
        bra start
        mov #0xC0, w0
        mov w0, I2CTRN
sent:   btsc I2CSTAT, #14
        bra sent
        bset I2CCON, #2
stop:   btsc I2CCON, #2
        bra stop
        inc w5, w5
        bra again
)",
                                         options);
        for (const auto& [address, word] : program.words)
            chip.load_word(address, word);
        chip.power_on();
        constexpr Time kEnd = 3 * cosim::kMillisecond;
        for (Time until = step; chip.now() < kEnd;) {
            chip.run_until(std::min(until, kEnd));
            if (chip.now() < std::min(until, kEnd)) pauses.push_back(chip.now());
            if (pins.due <= chip.now()) {
                CHECK(pins.due == chip.now());
                pins.due = cosim::kNever;
                chip.i2c_answer(1, {.kind = cosim::I2cPhaseKind::Acknowledge});
            }
            until = std::max(until, chip.now() + step);
        }
        std::vector<Time> starts;
        for (const cosim::I2cPhase& phase : pins.phases)
            starts.push_back(phase.start);
        return starts;
    };
    std::vector<Time> few, many;
    const std::vector<Time> whole = run(3 * cosim::kMillisecond, few);
    CHECK(whole.size() > 20);
    CHECK(few.size() > 10);
    CHECK(run(7 * cosim::kMicrosecond, many) == whole);
}
