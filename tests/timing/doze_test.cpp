// Doze of the 33FJ, timed by programs: docs/timing_rules.md, rules D1 to D6. Timer1 and Timer2 count the
// peripherals' clock, the program runs on the CPU's.

#include "tests/kit/dspic33_pieces.h"
#include "tests/timing/timed_chip.h"

#include "base/random.h"
#include "base/states/archive.h"
#include "emu/dspic/core/core.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const DeviceInfo& device() {
    return dspic33fj256gp710();
}

constexpr int kTimer2 = 7;  ///< IRQ
constexpr unsigned kPlain = 0x3040, kDozen = 0x0800, kRoi = 0x8000;

/// CLKDIV with the ratio 2^`doze`, PLL bits as reset leaves them.
unsigned dozing(unsigned doze, unsigned more = 0) {
    return 0x0040 | doze << 12 | kDozen | more;
}

/// Code of every kind of cycle: branches, repeats, loops, stalls, tables, the PSV window.
std::string drawn_code(RandomStream& random, int count) {
    static const char* const kKinds[] = {
        "nop",
        "inc w6, w6",
        "mov.d w4, w6",
        "tblrdl [w8], w6",
        "mul.uu w4, w5, w6",
        "repeat #{1}\n        inc w5, w5",
        "repeat #{1}\n        nop",
        "repeat #17\n        div.u w12, w13",
        "mov #0x1400, w8\n        mov [w8], w6",
        "bra {0}\n        nop\n{0}:",
        "btss w4, #0\n        inc w6, w6",
        "btss w4, #0\n        goto {0}\n{0}:",
        "rcall sub",
        "mov #{1}, w3\n{0}: dec w3, w3\n        bra nz, {0}",
        "do #{1}, {0}\n        inc w4, w4\n{0}: inc w5, w5",
        "mov [w9], w6",
        "add w4, [w9], w6",
    };
    std::string text;
    for (int i = 0; i < count; ++i)
        text +=
            fmt::format("        {}\n", fmt::format(fmt::runtime(kKinds[random.next() % std::size(kKinds)]),
                                                    fmt::format("l{}", i), 1 + random.next() % 30));
    return text;
}

/// Runs `code` once at each ratio, timed by TMR1 to 0x1300 and so on; leaves what it computed in W4 to W7.
std::string timed_code(const std::string& code, unsigned clkdiv) {
    return fmt::format(R"(
        goto    main
        .org    0x200
sub:    return
        .pword  0x001234
main:   mov     #{:#x}, w15
        mov     #0x8200, w9
        bset    CORCON, #2          ; PSV
        mov     #0x1400, w8
        mov     #7, w13
        clr     w12
        mov     #1, w4
        mov     #2, w5
        clr     w6
        clr     w7
        setm    PR1
        mov     #0x8000, w0
        mov     w0, T1CON
        mov     #{:#x}, w0
        mov     w0, CLKDIV
        mov     TMR1, w10
{}
        mov     TMR1, w11
        mov     #0x3040, w0
        mov     w0, CLKDIV
        sub     w11, w10, w11
        mov     w11, 0x1300
        mov     w4, 0x1302
        mov     w5, 0x1304
        mov     w6, 0x1306
        mov     w7, 0x1308
end:    bra     end
)",
                       device().ram_start + 0x200, clkdiv, code);
}

/// Timer2 interrupts `wait` counts after it was started, under `code` at a priority of 4.
std::string one_interrupt(unsigned clkdiv, int wait, const std::string& code) {
    return fmt::format(R"(
        goto    main
        .org    {:#x}
        .pword  isr
        .org    0x200
isr:    mov     TMR2, w1
        mov     TMR1, w2
        mov     CLKDIV, w3
        clr     T2CON
        mov     w1, 0x1300
        mov     w2, 0x1302
        mov     w3, 0x1304
        mov     w4, 0x1306
end:    bra     end
sub:    return
main:   mov     #{:#x}, w15
        mov     #0x1400, w8
        mov     #0x1402, w9
        clr     w12
        mov     #7, w13
        clr     w5
        clr     w6
        clr     w7
        setm    PR1
        mov     #0x8000, w0
        mov     w0, T1CON
        bset    IEC0, #{}
        mov     #{}, w1
        mov     w1, PR2
        mov     #{:#x}, w1
        mov     w1, CLKDIV
        mov     w0, T2CON
        mov     TMR1, w4
{}
stay:   bra     stay
)",
                       device().ivt + 2 * (kTrapVectors + kTimer2), device().ram_start + 0x200, kTimer2, wait,
                       clkdiv, code);
}

}  // namespace

TEST_CASE("in Doze every instruction takes its cycles times 2^DOZE of the peripherals' clock") {
    RandomStream random(Catch::rngSeed(), "doze");
    for (int i = 0; i < 30; ++i) {
        const std::string code = drawn_code(random, 12);
        INFO(code);
        TimedChip plain(device(), timed_code(code, kPlain));
        plain.run_to("end");
        for (unsigned doze = 0; doze < 8; ++doze) {
            if (plain.word(0x1300) << doze > 0xFFFF) break;  // TMR1 goes round
            TimedChip slow(device(), timed_code(code, dozing(doze)));
            slow.run_to("end");
            CHECK(slow.word(0x1300) == plain.word(0x1300) << doze);
            for (int at = 0x1302; at <= 0x1308; at += 2)
                CHECK(slow.word(at) == plain.word(at));
        }
    }
}

TEST_CASE("Doze begins behind the instruction that sets DOZEN, and ends behind the one that clears it") {
    RandomStream random(Catch::rngSeed(), "doze entry");
    for (int i = 0; i < 40; ++i) {
        const unsigned doze = static_cast<unsigned>(random.next() % 8);
        const unsigned other = static_cast<unsigned>(random.next() % 8);
        const int first = static_cast<int>(random.next() % 20), second = static_cast<int>(random.next() % 20);
        std::string nops[2];
        for (int n = 0; n < first; ++n)
            nops[0] += "        nop\n";
        for (int n = 0; n < second; ++n)
            nops[1] += "        nop\n";
        // With a bit instruction, and hot, so that translated code comes by here.
        const std::string source = fmt::format(R"(
        goto    main
        .org    0x200
main:   mov     #{:#x}, w15
        setm    PR1
        mov     #0x8000, w0
        mov     w0, T1CON
        mov     #{:#x}, w1
        mov     #{:#x}, w2
        mov     #{:#x}, w3
        mov     w1, CLKDIV
again:  mov     TMR1, w10
        bset    CLKDIV, #11
{}      mov     w2, CLKDIV
{}      mov     w3, CLKDIV
        mov     TMR1, w11
        sub     w11, w10, w11
        mov     w11, 0x1300
        mov     w1, CLKDIV
round:  goto    again
)",
                                               device().ram_start + 0x200, dozing(doze) & ~kDozen,
                                               dozing(other), kPlain, nops[0], nops[1]);
        for (const int rounds : {1, 300}) {
            TimedChip run(device(), source);
            for (int n = 0; n < rounds; ++n)
                run.run_to("round");
            INFO(source);
            CHECK(run.word(0x1300) == 1 + ((first + 1) << doze) + ((second + 1) << other) + 1);
        }
    }
}

TEST_CASE("timers and UART keep their pace while the CPU dozes") {
    RandomStream random(Catch::rngSeed(), "doze peripherals");
    for (unsigned doze = 0; doze < 8; ++doze) {
        const int brg = 5 + static_cast<int>(random.next() % 20);
        const int period = 2000 + static_cast<int>(random.next() % 2000);
        TimedChip run(device(), fmt::format(R"(
        goto    main
        .org    0x200
main:   mov     #{:#x}, w15
        clr     TRISB
        mov     #{}, w0
        mov     w0, PR2
        mov     #0x8000, w0
        mov     w0, T2CON
        mov     #{:#x}, w0
        mov     w0, CLKDIV
        mov     #{}, w0
        mov     w0, U1BRG
        mov     #0x8000, w0
        mov     w0, U1MODE
        mov     #0x0400, w0
        mov     w0, U1STA
        mov     #0x55, w0
        mov     w0, U1TXREG
        mov     w0, U1TXREG
        mov     w0, U1TXREG
stay:   bra     stay
)",
                                            device().ram_start + 0x200, period - 1, dozing(doze), brg));
        std::vector<Cycle> flags;
        while (flags.size() < 6) {
            run.chip.run_until(run.chip.now() + cosim::kMicrosecond / 8);
            if (!(run.chip.peek("IFS0") >> kTimer2 & 1)) continue;
            flags.push_back(run.chip.clock().first_cycle_at(run.chip.now()));
            run.chip.inside().core.write_data(0x084, 0);
        }
        for (std::size_t n = 1; n < flags.size(); ++n)
            CHECK(static_cast<int>(flags[n] - flags[n - 1]) == Approx(period).margin(1));
        REQUIRE(run.pins.frames.size() == 3);
        const cosim::ClockDomain& clock = run.chip.clock();
        for (int n = 1; n < 3; ++n) {
            const auto& frame = run.pins.frames[static_cast<std::size_t>(n)].second;
            const auto& before = run.pins.frames[static_cast<std::size_t>(n - 1)].second;
            CHECK(clock.first_cycle_at(frame.start) - clock.first_cycle_at(before.start) ==
                  static_cast<Cycle>(10 * 16 * (brg + 1)));
        }
    }
}

TEST_CASE("in Doze a handler begins in the fifth CPU cycle behind the flag's, with ROI in the fifth of 1:1") {
    RandomStream random(Catch::rngSeed(), "doze latency");
    for (int i = 0; i < 120; ++i) {
        const unsigned doze = static_cast<unsigned>(random.next() % 8);
        const bool recovers = random.next() % 2;
        const int ratio = 1 << doze;
        const int wait = 10 * ratio + static_cast<int>(random.next() % 4000);
        std::string nops;
        for (int n = 0; n < 600; ++n)
            nops += "        nop\n";
        TimedChip run(device(), one_interrupt(dozing(doze, recovers ? kRoi : 0), wait, nops));
        run.run_to("end");
        CAPTURE(doze, recovers, wait);
        const int since_flag = run.word(0x1300), grid = run.word(0x1306);
        const int began = run.word(0x1302) - (recovers ? 1 : ratio);
        const int flag = began - since_flag;
        // The last cycle of the CPU cycle in which the flag came: instructions read in the last one.
        const int taken = grid + (flag - grid + ratio - 1) / ratio * ratio;
        CHECK(began == taken + 5 * (recovers ? 1 : ratio));
        CHECK(static_cast<unsigned>(run.word(0x1304)) ==
              (recovers ? (dozing(doze, kRoi) & ~kDozen) : dozing(doze)));
    }
}

TEST_CASE("ROI leaves Doze on where the CPU's priority holds the interrupt back") {
    for (const bool held : {true, false}) {
        TimedChip run(device(),
                      one_interrupt(dozing(4, kRoi), 300,
                                    (held ? std::string("        mov #0x00E0, w5\n") + "        mov w5, SR\n"
                                          : std::string()) +
                                        "        repeat #100\n        nop\n"));
        run.chip.run_until(5 * cosim::kMillisecond);
        CHECK(bool(run.chip.peek("CLKDIV") & kDozen) == held);
        CHECK((run.chip.peek("IFS0") >> kTimer2 & 1) == 1);
    }
}

TEST_CASE("in Doze Idle ends with an interrupt, with ROI at full speed, a trap recovers as well") {
    for (const bool recovers : {false, true}) {
        TimedChip run(device(), one_interrupt(dozing(5, recovers ? kRoi : 0), 3000, "        pwrsav #1\n"));
        run.run_to("end");
        CAPTURE(recovers);
        CHECK(run.word(0x1300) == (recovers ? 4 : 31 + 4 * 32));
        CHECK(bool(run.chip.peek("CLKDIV") & kDozen) == !recovers);
    }
    TimedChip trapped(device(), fmt::format(R"(
        goto    main
        .org    0x0C
        .pword  trap
        .org    0x200
trap:   bra     trap
main:   mov     #{:#x}, w15
        mov     #{:#x}, w0
        mov     w0, CLKDIV
        clr     w4
        repeat  #17
        div.u   w2, w4
end:    bra     end
)",
                                            device().ram_start + 0x200, dozing(3, kRoi)));
    trapped.run_to("trap");
    CHECK_FALSE(trapped.chip.peek("CLKDIV") & kDozen);
}

TEST_CASE("DISI counts CPU cycles in Doze, and goes on counting them when the ratio changes") {
    RandomStream random(Catch::rngSeed(), "doze disi");
    for (int i = 0; i < 20; ++i) {
        const unsigned first = static_cast<unsigned>(random.next() % 8);
        const unsigned second = static_cast<unsigned>(random.next() % 8);
        const int count = 20 + static_cast<int>(random.next() % 100);
        TimedChip run(device(),
                      fmt::format(R"(
        goto    main
        .org    0x200
main:   mov     #{:#x}, w15
        mov     #{:#x}, w1
        mov     #{:#x}, w2
        mov     w1, CLKDIV
        disi    #{}
        nop
        mov     DISICNT, w3
        mov     w2, CLKDIV
        nop
        mov     DISICNT, w4
        mov     #{:#x}, w0
        mov     w0, CLKDIV
        mov     DISICNT, w5
        mov     w3, 0x1300
        mov     w4, 0x1302
        mov     w5, 0x1304
end:    bra     end
)",
                                  device().ram_start + 0x200, dozing(first), dozing(second), count, kPlain));
        run.run_to("end");
        CHECK(run.word(0x1300) == count - 1);
        CHECK(run.word(0x1302) == count - 4);
        CHECK(run.word(0x1304) == count - 7);
    }
}

TEST_CASE("OSCCON's keys open in Doze, and a clock switch leaves the ratio as it is") {
    TimedChip run(device(),
                  fmt::format(R"(
        goto    main
        .org    0x200
main:   mov     #{:#x}, w15
        mov     #{:#x}, w0
        mov     w0, CLKDIV
{}lock:   btsc    OSCCON, #0
        bra     lock
end:    bra     end
)",
                              device().ram_start + 0x200, dozing(5) | 0x0100, tests::clock_switch(7)),
                  {{0xF80008, 0xFF7D}});
    run.run_to("end");
    CHECK(run.chip.peek("OSCCON") == 0x7700);
    CHECK(run.chip.clock().hertz() == 7.37e6 / 4);
    const Cycle before = run.chip.cycle();
    run.run_to("end");
    CHECK(run.chip.cycle() - before == 64);  // BRA
    run.chip.mclr();
    run.chip.run_until(run.chip.now() + 1);
    CHECK(run.chip.peek("CLKDIV") == kPlain);
}

TEST_CASE("a dozing chip is saved, goes on where it was, and steps as it runs") {
    RandomStream random(Catch::rngSeed(), "doze state");
    for (int i = 0; i < 10; ++i) {
        const std::string source =
            one_interrupt(dozing(static_cast<unsigned>(1 + random.next() % 7), random.next() % 2 ? kRoi : 0),
                          2000, drawn_code(random, 30));
        TimedChip whole(device(), source), cut(device(), source);
        const cosim::Time end = 20 * cosim::kMillisecond;
        whole.chip.run_until(end);
        cosim::Time at = 0;
        while (at < end) {
            at = std::min<cosim::Time>(end, at + 1 + static_cast<cosim::Time>(random.below(2'000'000'000)));
            cut.chip.run_until(at);
            std::vector<std::uint8_t> bytes;
            StateWriter writer(bytes);
            std::as_const(cut.chip).state(writer);
            TimedChip other(device(), source);
            StateReader reader(bytes);
            other.chip.state(reader);
            other.chip.run_until(end);
            CHECK(other.chip.cycle() == whole.chip.cycle());
            CHECK(other.word(0x1302) == whole.word(0x1302));
            CHECK(other.chip.report().instructions == whole.chip.report().instructions);
        }
        CHECK(cut.chip.cycle() == whole.chip.cycle());
        CHECK(cut.chip.report().instructions == whole.chip.report().instructions);
    }
}
