// Where remembered service routines and the steps inside loops might show: each place by a program made for
// it, beside a core that executes every cycle.

#include "tests/dspic/skips/path_bench.h"

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

constexpr int kT1 = 3, kT2 = 6;
constexpr std::uint16_t kPolled = 0x0D8;  ///< unused word of the SFR space, plain storage

/// Both interrupts on; a loop that waits for a word that never comes.
const std::string kWaits = R"(
        mov     #0x1000, w15
        mov     #0x0900, w14
        clr     w0
        clr     w1
        bset    0x8c, #3
        bset    0x8c, #6
wait:   mov     0x0C00, w0
        cp0     w0
        bra     z, wait
        bra     wait
)";
/// Counts, so that it has no summary.
std::string counting(const std::string& name, const std::string& flag, const std::string& more = "") {
    return name + ":    push    w0\n        push    w1\n        inc     0x0C10\n" + more +
           "        bclr    " + flag + "\n        pop     w1\n        pop     w0\n        retfie\n";
}

/// The polled register is there, and every other time that so many cycles are over its module is not.
void takes_away_polled(PathBench& bench, Cycle every) {
    bench.both([](Rig& rig) {
        rig.sfr.claim(kPolled);
        rig.sfr.raw(kPolled) = 5;
    });
    bench.raises(kT1, "isr", 501, 703);
    bench.every(30'000, every,
                [every](Rig& rig, Cycle due) { rig.sfr.set_off(kPolled, due / every % 2 != 0); });
}

}  // namespace

TEST_CASE("what a routine writes to RCOUNT and PSVPAG has their widths when it reads it back") {
    for (const char* address : {"0x34", "0x36"}) {
        const std::string at = address;
        PathBench bench(kWaits +
                        counting("isr", "0x84, #3",
                                 "        push    " + at + "\n        mov     #0xC123, w0\n" +
                                     "        mov     w0, " + at + "\n        mov     " + at +
                                     ", w1\n        mov     w1, 0x0C12\n        pop     " + at + "\n"));
        bench.raises(kT1, "isr", 500, 700);
        for (Cycle at_cycle = 1000; at_cycle < 200'000; at_cycle += 9973)
            bench.compare(at_cycle);
    }
}

TEST_CASE("two interrupts at once: the remembered routine does not swallow the other one") {
    PathBench bench(kWaits + counting("isr", "0x84, #3") +
                    counting("other", "0x84, #6", "        inc     0x0C14\n"));
    bench.raises(kT1, "isr", 500, 700);
    bench.raises(kT2, "other", 500 + 700 * 100, 1400);
    for (Cycle at = 1000; at < 400'000; at += 9973)
        bench.compare(at);
}

TEST_CASE("a flag that falls into a remembered routine makes its return a cycle shorter") {
    // Seen by a cut on the cycle behind the shorter one. T1 ranks above T2.
    for (Cycle later = 1; later < 20; ++later) {
        PathBench bench("        mov     #0x5444, w0\n        mov     w0, 0x94\n" + kWaits +
                        counting("isr", "0x84, #3") +
                        counting("other", "0x84, #6", "        inc     0x0C14\n"));
        constexpr Cycle kFirst = 1000, kPeriod = 300;
        bench.raises(kT1, "isr", kFirst, kPeriod);
        bench.raises(kT2, "other", kFirst + later, kPeriod);
        for (Cycle round = 600; round < 624; ++round)
            bench.compare(kFirst + round * kPeriod + 8 + round % 24);
    }
}

TEST_CASE("a loop polls a register whose module is taken away") {
    PathBench bench(R"(
        mov     #0x1000, w15
        clr     w0
        bset    0x8c, #3
wait:   mov     0x0d8, w0
        nop
        nop
        cp0     w0
        bra     nz, wait
        inc     0x0C20
        bra     wait
)" + counting("isr", "0x84, #3"));
    takes_away_polled(bench, 20'011);
    for (Cycle at = 1000; at < 400'000; at += 9973)
        bench.compare(at);
}

TEST_CASE("tasks that share a waiting loop at different depths of their stacks") {
    // T2 exchanges the tasks' stack pointers: the loop goes on at another depth, where it is no part of the
    // loop that the other task goes round in.
    PathBench bench(R"(
        mov     #0x1100, w15
        mov     #task, w0
        mov     w0, [w15++]
        clr     w0
        mov     w0, [w15++]
        mov     w0, [w15++]
        mov     w15, 0x0C40
        mov     #0x1400, w15
        clr     w1
        bset    0x8c, #3
        bset    0x8c, #6
deep:   rcall   shared
        mov     #100, w2
count:  dec     w2, w2
        bra     nz, count
        bra     deep
task:   rcall   shared
        nop
        bra     task
shared:
wait:   mov     0x0C02, w1
        cp0     w1
        bra     z, wait
        return
other:  push    w0
        push    0x0C40
        pop     0x0C42
        mov     w15, 0x0C40
        mov     0x0C42, w15
        bclr    0x84, #6
        pop     w0
        retfie
)" + counting("isr", "0x84, #3"));
    bench.raises(kT1, "isr", 501, 703);
    bench.raises(kT2, "other", 9000, 5003);
    bench.every(1777, 977,
                [](Rig& rig, Cycle due) { rig.core.ram()[(0x0C02 - 0x0800) / 2] = due / 977 % 4 == 0; });
    for (Cycle at = 1000; at < 2'000'000; at += 499)
        bench.compare(at);
}

TEST_CASE("a loop inside the loop comes round between two cuts") {
    PathBench bench(R"(
        mov     #0x1000, w15
        clr     w0
        clr     w1
        bset    0x8c, #3
wait:   mov     #9, w1
in:     dec     w1, w1
        bra     nz, in
        nop
        nop
        nop
        mov     #9, w1
in2:    dec     w1, w1
        bra     nz, in2
        mov     0x0C00, w0
        cp0     w0
        bra     z, wait
isr:    push    w0
        mov     #3, w0
i:      dec     w0, w0
        bra     nz, i
        inc     0x0C10
        bclr    0x84, #3
        pop     w0
        retfie
)");
    bench.raises(kT1, "isr", 501, 151);
    for (Cycle at = 1000; at < 200'000; at += 37)
        bench.compare(at);
}

TEST_CASE("a routine reads a register whose module is taken away") {
    PathBench bench(kWaits +
                    counting("isr", "0x84, #3", "        mov     0x0d8, w0\n        mov     w0, 0x0C16\n"));
    takes_away_polled(bench, 90'011);
    for (Cycle at = 1000; at < 900'000; at += 9973)
        bench.compare(at);
}
