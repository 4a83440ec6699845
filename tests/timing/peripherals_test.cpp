// Times of peripherals' events, to the cycle: docs/timing_rules.md, rules P and C.

#include "tests/timing/timed_chip.h"

#include "base/random.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const DeviceInfo* const kDevices[] = {&dspic30f6014a(), &dspic33fj256gp710()};
constexpr Cycle kEntry = 5;  ///< from an interrupt's flag to its handler, rule X1

int irq_of(const DeviceInfo& device, const std::string& name) {
    for (int irq = 0; irq < device.irq_count; ++irq)
        if (device.vector_name(kTrapVectors + irq) == name) return irq;
    throw std::runtime_error("no interrupt " + name);
}

/// `setup` and `start`, one instruction each line, with the interrupt `name` on and its routine at isr.
std::string with_interrupt(const DeviceInfo& device, const std::string& name, const std::string& setup,
                           const std::string& start) {
    const int irq = irq_of(device, name);
    return fmt::format(R"(
        goto    main
        .org    {:#x}
        .pword  isr
        .org    0x200
isr:    bclr    IFS{}, #{}
        retfie
main:   mov     #{:#x}, w15
        bset    IEC{}, #{}
{}
start:  {}
behind: bra     behind
)",
                       device.ivt + 2u * static_cast<unsigned>(kTrapVectors + irq), irq / 16, irq % 16,
                       device.ram_start + 0x200, irq / 16, irq % 16, setup, start);
}

}  // namespace

TEST_CASE("each timer's interrupt comes every (PR + 1) x prescaler cycles, from the cycle behind its start") {
    RandomStream random(Catch::rngSeed(), "timers");
    for (const DeviceInfo* device : kDevices)
        for (int timer = 1; timer <= (device->family_33f ? 9 : 5); ++timer)
            for (int code = 0; code < 4; ++code) {
                static constexpr Cycle kPrescale[] = {1, 8, 64, 256};
                const auto period = static_cast<Cycle>(40 + random.next() % 300);
                const std::string source = with_interrupt(
                    *device, fmt::format("T{}", timer),
                    fmt::format("        mov #{}, w1\n        mov w1, PR{}\n        mov #{:#x}, w2\n",
                                period - 1, timer, 0x8000 | code << 4),
                    fmt::format("mov w2, T{}CON", timer));
                TimedChip run(*device, source);
                INFO(device->name << ", Timer" << timer << ", period " << period << " by "
                                  << kPrescale[code]);
                const Cycle start = run.run_to("start");
                for (int i = 1; i <= 3; ++i)
                    CHECK(run.run_to("isr") == start + 1 + i * period * kPrescale[code] + kEntry);
            }
}

TEST_CASE("a write to TMRx clears the prescaler, one to TxCON keeps it") {
    RandomStream random(Catch::rngSeed(), "phases");
    for (const DeviceInfo* device : kDevices)
        for (const bool count : {true, false}) {
            const auto before = static_cast<Cycle>(100 + random.next() % 400);
            constexpr Cycle kPeriod = 50, kPrescale = 64;
            const std::string source = with_interrupt(
                *device, "T2",
                fmt::format(
                    "        mov #{}, w1\n        mov w1, PR2\n        mov #0x8020, w2\n        clr w3\n"
                    "first:  mov w2, T2CON\n        repeat #{}\n        nop\n",
                    kPeriod - 1, before),
                count ? "mov w3, TMR2" : "mov w2, T2CON");
            TimedChip run(*device, source);
            INFO(device->name << ", " << before << (count ? ", TMR2" : ", T2CON"));
            const Cycle first = run.run_to("first"), start = run.run_to("start");
            CHECK(run.run_to("isr") == (count ? start : first) + 1 + kPeriod * kPrescale + kEntry);
        }
}

TEST_CASE("a UART's frames follow each other by bits x 16 x (BRG + 1) cycles, by 4 with BRGH") {
    RandomStream random(Catch::rngSeed(), "frames");
    for (const DeviceInfo* device : kDevices)
        for (int i = 0; i < 12; ++i) {
            const int unit = 1 + i % 2, brg = 1 + static_cast<int>(random.next() % 60);
            const bool fast = device->family_33f && random.next() % 2;
            const int parity = static_cast<int>(random.next() % 4),
                      stops = static_cast<int>(random.next() % 2);
            // 8N, 8E, 8O, 9N: start bit, data, parity, stop bits.
            const int bits = 1 + (parity == 0 ? 8 : 9) + 1 + stops;
            const Cycle bit = (fast ? 4 : 16) * (brg + 1);
            const std::string source = fmt::format(
                "        goto main\n        .org 0x200\nmain:   mov #{}, w0\n        mov w0, U{}BRG\n"
                "        mov #{:#x}, w0\n        mov w0, U{}MODE\n        mov #0x0400, w0\n        mov w0, "
                "U{}STA\n"
                "        mov w1, U{}TXREG\n        mov w1, U{}TXREG\n        mov w1, U{}TXREG\nstay:   bra "
                "stay\n",
                brg, unit, 0x8000 | (fast ? 8 : 0) | parity << 1 | stops, unit, unit, unit, unit, unit);
            TimedChip run(*device, source);
            run.chip.run_until(run.chip.clock().time_of(60 * bit + 500));
            INFO(device->name << ", UART" << unit << ", BRG " << brg << ", " << bits << " bits"
                              << (fast ? ", BRGH" : ""));
            REQUIRE(run.pins.frames.size() == 3);
            const double cycle = 1e12 / run.chip.clock().hertz();
            for (std::size_t f = 0; f < 3; ++f) {
                const cosim::UartFrame& frame = run.pins.frames[f].second;
                CHECK(run.pins.frames[f].first == unit);
                CHECK(static_cast<double>(frame.bit_period) / cycle == Approx(bit).epsilon(1e-5));
                if (f == 0) continue;
                const auto gap = static_cast<double>(frame.start - run.pins.frames[f - 1].second.start);
                CHECK(gap / cycle == Approx(bits * bit).epsilon(1e-6));
            }
        }
}

TEST_CASE("a conversion ends SAMC + 14 TAD after sampling began, with 10 bits + 12, the 30F's TAD counts "
          "half cycles") {
    RandomStream random(Catch::rngSeed(), "conversions");
    for (const DeviceInfo* device : kDevices)
        for (int i = 0; i < 8; ++i) {
            const int samc = 1 + static_cast<int>(random.next() % 30);
            const int adcs =
                2 * static_cast<int>(5 + random.next() % 20) - 1;  // whole cycles on the 30F, too
            const bool twelve = !device->family_33f || i % 2;
            const Cycle tad = device->family_33f ? adcs + 1 : (adcs + 1) / 2;
            const std::string unit = device->family_33f ? "AD1" : "AD";
            const std::string source =
                with_interrupt(*device, device->family_33f ? "AD1" : "ADC",
                               fmt::format("        mov #{:#x}, w1\n        mov w1, {}CON3\n        mov "
                                           "#{:#x}, w1\n        mov w1, {}CON1\n",
                                           samc << 8 | adcs, unit,
                                           0x80E0 | (device->family_33f && twelve ? 0x400 : 0), unit),
                               "bset " + unit + "CON1, #1");
            TimedChip run(*device, source);
            INFO(device->name << ", SAMC " << samc << ", ADCS " << adcs
                              << (twelve ? ", 12 bits" : ", 10 bits"));
            const Cycle start = run.run_to("start");
            CHECK(run.run_to("isr") == start + 1 + (samc + (twelve ? 14 : 12)) * tad + kEntry);
        }
}

TEST_CASE(
    "the watchdog's period is 2 ms x prescalers A and B on the 30F, LPRC / 32 or 128 / 2^n on the 33FJ") {
    RandomStream random(Catch::rngSeed(), "watchdog");
    for (const DeviceInfo* device : kDevices)
        for (int a = 0; a < (device->family_33f ? 2 : 4); ++a) {
            static constexpr double kA[] = {1, 8, 64, 512};
            const int b = static_cast<int>(random.next() % (device->family_33f ? 10 : 16));
            const double period = device->family_33f ? (a ? 128 : 32) * static_cast<double>(1 << b) / 32768
                                                     : 2e-3 * kA[a] * (b + 1);
            TimedChip run(
                *device, "        goto main\n        .org 0x200\nmain:   bset RCON, #5\nstay:   bra stay\n",
                {{device->family_33f ? 0xF8000A : 0xF80002,
                  static_cast<std::uint32_t>(device->family_33f ? 0x40 | a << 4 | b : a << 4 | b)}});
            INFO(device->name << ", A " << a << ", B " << b << ", " << period << " s");
            const double hertz = run.chip.clock().hertz();
            const Cycle set = run.run_to("main");
            run.chip.run_until(run.chip.clock().time_of(set + static_cast<Cycle>(1.5 * period * hertz)));
            const auto resets = run.chip.report().resets;
            REQUIRE(resets.size() == 2);
            CHECK(resets[1].cause == "WDTO");
            CHECK(static_cast<double>(resets[1].cycle - set) == Approx(period * hertz).margin(3));
        }
}

TEST_CASE(
    "a row of flash stops the CPU, 2 ms or 11064 RC cycles (33FJ), a word of EEPROM is written beside it") {
    for (const auto& [device, eeprom] :
         {std::pair{kDevices[0], false}, {kDevices[0], true}, {kDevices[1], false}}) {
        TimedChip run(
            *device,
            fmt::format(R"(
        goto    main
        .org    0x200
main:   mov     #{0:#x}, w0
        mov     w0, TBLPAG
        mov     #0xF000, w1
{2}
        tblwtl  w2, [w1]
        mov     #{1:#x}, w3
        mov     w3, NVMCON
        mov     #0x55, w4
        mov     w4, NVMKEY
        mov     #0xaa, w4
        mov     w4, NVMKEY
write:  bset    NVMCON, #15
behind: btsc    NVMCON, #15
        bra     behind
done:   bra     done
)",
                        eeprom ? 0x7F : 0, eeprom ? 0x4004 : 0x4001,
                        device->family_33f ? "" : "        mov w0, NVMADRU\n        mov w1, NVMADR\n"));
        const double length = (device->family_33f ? 11064 / 7.37e6 : 2e-3) * run.chip.clock().hertz();
        const Cycle write = run.run_to("write"), behind = run.run_to("behind"), done = run.run_to("done");
        INFO(device->name << (eeprom ? ", EEPROM" : ", flash"));
        CHECK(static_cast<double>(behind - write) == Approx(eeprom ? 1 : 1 + length).margin(eeprom ? 0 : 2));
        CHECK(static_cast<double>(done - write) == Approx(length).margin(6));  // a round of the loop
    }
}
