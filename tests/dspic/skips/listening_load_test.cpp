// A loop that counts to 50 000 under the interrupts of a listening e-puck (docs/ircom.md), as a program of
// our own: the converter's scans, two timers and their handlers of known length.

#include "emu/dspic/chip/chip.h"

#include "emu/dspic/assembler/assembler.h"

#include <catch2/catch.hpp>

#include <fmt/format.h>

#include <string>

using namespace puckloop;
using namespace puckloop::dspic;

namespace {

struct NoPins : Pins {
    void driven(PortLetter, std::uint16_t, std::uint16_t, Cycle) override {}
    std::uint16_t levels(PortLetter, Cycle) override { return 0; }
    double analog(int, Cycle) override { return 0.5; }
    void uart_sent(int, const cosim::UartFrame&) override {}
    void i2c_phase(int, const cosim::I2cPhase&) override {}
};

constexpr double kTcy = 1.0 / 14'745'600.0;
constexpr Cycle kSpin = 5 + 50'000 * 15 + 7;
constexpr Cycle kEntry = 4;
constexpr Cycle kAdc = 162, kAgenda = 35, kTick = 76, kWindow = 7224;  // with RETFIE
constexpr Cycle kScan = 1200, kAgendaPeriod = 1475, kTickPeriod = 1480;

/// Each handler's cycles are its REPEAT count and a fixed rest. RAM: 0x902 scans, 0x904 ticks, 0x906 agenda,
/// 0x908 windows; 0x90A holds how many scans make a window.
std::string source(int scans_of_window) {
    return fmt::format(R"(
        goto main
        .org 0x1A
        .pword tick
        .org 0x20
        .pword agenda
        .org 0x2A
        .pword scan
        .org 0x100
main:   mov #0x1000, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        lnk #6
        clr 0x902
        clr 0x904
        clr 0x906
        clr 0x908
        mov #{}, w0
        mov w0, 0x90A
        clr w11
        mov #0x00E4, w0         ; conversion starts by itself, sampling too
        mov w0, ADCON1
        mov #0x041C, w0         ; scan, interrupt after eight
        mov w0, ADCON2
        mov #0x0113, w0         ; SAMC 1, ADCS 19
        mov w0, ADCON3
        clr ADCHS
        mov #0x0003, w0
        mov w0, ADPCFG
        mov #0xFF00, w0
        mov w0, ADCSSL
        mov #0x6444, w0         ; T1 6
        mov w0, IPC0
        mov #0x7444, w0         ; ADC 7
        mov w0, IPC2
        mov #184, w0
        mov w0, PR1
        mov #1474, w0
        mov w0, PR2
        mov #0x0848, w0
        mov w0, IEC0
        mov #0x8000, w0
        mov w0, T2CON
        mov #0x8010, w0         ; 1:8
        mov w0, T1CON
        bset ADCON1, #15
spin:   mul.uu w0, #0, w0
        mov w0, [w14+2]
        mov w1, [w14+4]
        bra test
count:  nop
        mov [w14+2], w0
        mov [w14+4], w1
        add w0, #1, w0
        addc w1, #0, w1
        mov w0, [w14+2]
        mov w1, [w14+4]
test:   mov [w14+2], w2
        mov [w14+4], w3
        mov #0xC34F, w0
        mov #0, w1
        sub w2, w0, [w15]
        subb w3, w1, [w15]
        bra le, count
over:   bra over
scan:   push 0x36
        bclr IFS0, #11
        inc 0x902
        repeat #{}
        nop
        pop 0x36
        retfie
agenda: push 0x36
        bclr IFS0, #6
        inc 0x906
        repeat #{}
        nop
        pop 0x36
        retfie
tick:   push 0x36
        bclr IFS0, #3
        inc 0x904
        mov 0x902, w10
        sub w10, w11, w12
        mov 0x90A, w13
        sub w12, w13, [w15]
        bra ltu, idle
        mov w10, w11
        inc 0x908
        repeat #{}
        nop
        bra out
idle:   repeat #{}
        nop
out:    pop 0x36
        retfie
)",
                       scans_of_window, kAdc - 9, kAgenda - 9, kWindow - 18, kTick - 15);
}

struct Counts {
    Cycle elapsed;
    int scans, ticks, agenda, windows;
};

Counts count(int scans_of_window, bool skip) {
    AssembleOptions options;
    for (const RegisterInfo& info : dspic30f6014a().registers)
        options.predefined[std::string(info.name)] = info.address;
    const Program program = assemble(source(scans_of_window), options);
    NoPins pins;
    Chip chip(dspic30f6014a(), pins, {.fosc = std::uint16_t{0xFFE6}});  // crystal x8
    chip.set_skipping(skip);
    for (const auto& [address, word] : program.words)
        chip.load_word(address, word);
    chip.power_on();
    chip.stop_at(program.symbols.at("spin"));
    chip.stop_at(program.symbols.at("over"));
    chip.run_until(cosim::kSecond);
    REQUIRE(chip.pc() == program.symbols.at("spin"));
    const Cycle begun = chip.cycle();
    chip.run_until(cosim::kSecond);
    REQUIRE(chip.pc() == program.symbols.at("over"));
    const auto word = [&](std::uint16_t address) { return static_cast<int>(chip.peek_data(address)); };
    return {chip.cycle() - begun, word(0x902), word(0x904), word(0x906), word(0x908)};
}

/// What the spin takes by the data sheet; each RETFIE that another interrupt follows at once (one in six
/// here) is a cycle less.
void check_sum(const Counts& c) {
    const Cycle sum = kSpin + c.scans * (kAdc + kEntry) + c.agenda * (kAgenda + kEntry) +
                      (c.ticks - c.windows) * (kTick + kEntry) + c.windows * (kWindow + kEntry);
    CHECK(c.elapsed <= sum);
    CHECK(c.elapsed >= sum - (c.scans + c.agenda + c.ticks) / 4);
}

}  // namespace

TEST_CASE("a counting loop under scans and two timers takes as long as by their periods and handlers") {
    const Counts c = count(0x7FFF, true);
    const double elapsed = static_cast<double>(c.elapsed);
    // 15 TAD of (19 + 1)/2 cycles for each of eight channels; PR + 1 counts, T1 behind 1:8.
    CHECK(c.scans == Approx(elapsed / kScan).margin(1));
    CHECK(c.ticks == Approx(elapsed / kTickPeriod).margin(1));
    CHECK(c.agenda == Approx(elapsed / kAgendaPeriod).margin(1));
    CHECK(c.windows == 0);
    check_sum(c);
    const double load = static_cast<double>(kAdc + kEntry) / kScan +
                        static_cast<double>(kTick + kEntry) / kTickPeriod +
                        static_cast<double>(kAgenda + kEntry) / kAgendaPeriod;
    CHECK(elapsed * kTcy == Approx(kSpin * kTcy / (1 - load)).epsilon(0.002));  // 65.1 ms of 50.9
}

TEST_CASE("a handler that is longer than the timers' periods costs its own time, and ticks are lost") {
    const Counts c = count(32, true);
    const double elapsed = static_cast<double>(c.elapsed);
    CHECK(c.scans == Approx(elapsed / kScan).margin(1));  // the converter's priority is above it
    CHECK(c.windows == Approx(elapsed / (32 * kScan)).margin(1.5));
    CHECK(c.ticks < 0.9 * elapsed / kTickPeriod);
    CHECK(c.agenda < 0.9 * elapsed / kAgendaPeriod);
    check_sum(c);
    CHECK(elapsed * kTcy == Approx(82.96e-3).epsilon(0.01));  // what the original firmware takes
    // And the same when every turn of the loop is executed.
    CHECK(count(32, false).elapsed == c.elapsed);
}
