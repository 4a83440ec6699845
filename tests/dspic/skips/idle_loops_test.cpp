// Busy-wait skipping changes nothing: the same program with and without it, cut at many places, under events
// and interrupts, must be in the same state at the same cycle.

#include "base/random.h"
#include "tests/dspic/skips/skipping.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using puckloop::RandomStream;

namespace {

/// Raises T1 at a steady pace and reports it; another event changes what loops look at, now and then.
struct SteadyTicker {
    Rig& rig;
    Cycle period;
    RandomStream random;
    EventQueue::Slot beat, change;

    SteadyTicker(Rig& owner, Cycle every, std::uint64_t seed)
        : rig(owner),
          period(every),
          random(seed, "changes"),
          beat(owner.events.add(this, &fire)),
          change(owner.events.add(this, &disturb)) {
        rig.events.schedule(beat, period);
        rig.events.set_steady(beat, {kT1, period, &pass});
        rig.events.schedule(change, 5000);
    }
    static void fire(void* self, Cycle due) {
        auto& t = *static_cast<SteadyTicker*>(self);
        t.rig.interrupts.raise(kT1, due);
        t.rig.events.schedule(t.beat, due + t.period);
    }
    static void pass(void* self, std::uint64_t times) {
        auto& t = *static_cast<SteadyTicker*>(self);
        t.rig.events.schedule(t.beat, t.rig.events.due(t.beat) + times * t.period);
    }
    static void disturb(void* self, Cycle due) {
        auto& t = *static_cast<SteadyTicker*>(self);
        switch (t.random.below(6)) {
        case 0:
            t.rig.sfr.raw(kPolled) ^= 1;
            break;
        case 1:
            t.rig.core.ram()[(0x0C00 - 0x0800) / 2] ^= 1;
            break;
        case 2:
            t.rig.sfr.raw(kRefreshed) ^= 2;  // the routine is no refresh for once
            break;
        default:
            break;
        }
        t.rig.events.schedule(t.change, due + 1 + t.random.below(9000));
    }
};

/// The same under a steady beat.
void compare_steady(const std::string& source, Cycle until, Cycle period, std::uint64_t seed) {
    Rig fast(source), slow(source);
    slow.core.set_skip_idle(false);
    for (Rig* rig : {&fast, &slow}) {
        rig->sfr.claim(kPolled);
        rig->sfr.claim(kRefreshed);
        rig->core.observer().on_interrupt = nullptr;
        rig->vector(kTrapVectors + kT1, "isr");
    }
    const SteadyTicker fast_ticker(fast, period, seed), slow_ticker(slow, period, seed);
    RandomStream cuts(seed, "cuts");
    for (Cycle at = 0; at < until;) {
        at += 1 + cuts.below(until / 8);
        fast.core.run(at);
        slow.core.run(at);
        INFO(source << "\nat " << at << ", a beat every " << period);
        REQUIRE(fingerprint(fast) == fingerprint(slow));
    }
}

/// A routine that leaves nothing but dead words on the stack, as a compiler without optimisation makes it.
const std::string kTracelessTail = R"(
done:   inc     w12, w12
        bra     again
isr:    push    w0
        push.d  w2
        lnk     #4
        mov     #2, w0
        mov     w0, 0x0da
        bclr    0x84, #3
        ulnk
        pop.d   w2
        pop     w0
        retfie
)";

}  // namespace

TEST_CASE("a 64-bit counter with a frame pointer, as a compiler without optimisation makes it") {
    const std::string source = kHead + R"(
again:  clr     w0
        mov.d   w0, [w14++]
        mov.d   w0, [w14--]
        bra     test
body:   nop
        mov.d   [w14++], w4
        mov.d   [w14--], w6
        mov     #1, w0
        mov     #0, w1
        mul.uu  w2, #0, w2
        add     w4, w0, [w14++]
        addc    w5, w1, [w14++]
        addc    w6, w2, [w14++]
        addc    w7, w3, [w14]
        sub     #6, w14
test:   mov     #0x1000, w0
        mov     #0x2, w1
        mul.uu  w2, #0, w2
        mov.d   [w14++], w4
        mov.d   [w14--], w6
        cp      w4, w0
        cpb     w5, w1
        cpb     w6, w2
        cpb     w7, w3
        bra     le, body
)" + kTail;
    for (const Cycle period : {Cycle{0}, Cycle{50'000}, Cycle{1474}, Cycle{131}})
        compare(source, 4'000'000, period, period);
}

TEST_CASE("nested delays, polling through calls, 32-bit countdowns, a self-branch") {
    const std::string sources[] = {
        kHead + R"(
again:  mov     #50, w10
outer:  mov     #0, w11
inner:  btss    0x0d8, #0
        bra     next
        bra     done
next:   clrwdt
        dec     w11, w11
        bra     nz, inner
        dec     w10, w10
        bra     nz, outer
)" + kTail,
        kHead + R"(
again:  rcall   ready
        cp0.b   w0
        bra     z, again
        bra     done
ready:  lnk     #0
        mov.b   0x0d8, wreg
        ze      w0, w0
        ulnk
        return
)" + kTail,
        kHead + R"(
again:  mov     #0x2710, w0
        mov     #0x1, w1
        mov.d   w0, [w14]
        bra     test
body:   mov.b   [w8], w0
        cp0.b   w0
        bra     nz, done
        setm    w0
        setm    w1
        add     w0, [w14], [w14]
        addc    w1, [++w14], [w14--]
test:   mov.d   [w14], w0
        sub     w0, #0, [w15]
        subb    w1, #0, [w15]
        bra     nz, body
)" + kTail,
        kHead + R"(
again:  mov     [w9], w1
wait:   mov     [w9], w0
        sub     w0, w1, [w15]
        bra     z, wait
)" + kTail,
        kHead + "again:  bra     again\n" + kTail,
        kHead +
            "again:  repeat  #3000\n        nop\n        mov #0x6000, w5\nd:      dec.b w5, w5\n        bra "
            "nz, d\n" +
            "e:      inc2 w6, w6\n        cp w6, w5\n        bra ltu, e\n        clr w6\n" + kTail,
    };
    for (const auto& source : sources)
        for (const Cycle period : {Cycle{0}, Cycle{20'011}, Cycle{997}, Cycle{113}})
            compare(source, 1'000'000, period, period + 1);
}

TEST_CASE("skipping really skips") {
    Rig rig(kHead + "again:  bra     again\n" + kTail);
    rig.core.run(1'000'000'000'000);
    CHECK(rig.core.cycle() >= 1'000'000'000'000);  // would take hours if executed
}

TEST_CASE("random loops") {
    RandomStream random(1, "random loops");
    const auto reg = [&] { return "w" + std::to_string(random.below(8)); };
    const auto instruction = [&]() -> std::string {
        const char* sizes[] = {"", "", "", ".b"};
        const std::string size = sizes[random.below(4)];
        const char* binary[] = {"add", "sub", "addc", "subb", "and", "ior", "xor", "subr"};
        const char* unary[] = {"inc", "dec", "inc2", "dec2", "com", "lsr", "sl", "mov", "clr"};
        const char* file[] = {"inc", "dec", "mov", "cp0"};
        switch (random.below(12)) {
        case 0:
        case 1:
            return std::string(binary[random.below(8)]) + size + " " + reg() + ", " + reg() + ", " + reg();
        case 2:
            return std::string(binary[random.below(8)]) + size + " " + reg() + ", #" +
                   std::to_string(random.below(32)) + ", " + reg();
        case 3: {
            const auto n = random.below(9);
            return std::string(unary[n]) + size + (n == 8 ? " " + reg() : " " + reg() + ", " + reg());
        }
        case 4: {
            const std::string address = std::to_string(0x0C00 + 2 * random.below(4));
            return std::string(file[random.below(3)]) + size + " " + address +
                   (random.below(2) ? ", wreg" : "");
        }
        case 5:
            return "mov" + size + " [w14+" + std::to_string(2 * random.below(4)) + "], " + reg();
        case 6:
            return "mov" + size + " " + reg() + ", [w14+" + std::to_string(2 * random.below(4)) + "]";
        case 7:
            return "cp" + size + " " + reg() + ", " + reg();
        case 8:
            return "mov [w8], " + reg();
        case 9:
            return "mov " + reg() + ", [w8]";
        case 10:
            return "inc [w9], [w9]";
        default:
            return random.below(2) ? "push " + reg() + "\n        pop " + reg() : "mov.b 0x0d8, wreg";
        }
    };
    const char* conditions[] = {"nz", "z", "gtu", "leu", "lt", "ge", "nc", "c", "nn", "n", "le", "nov"};
    for (int round = 0; round < 400; ++round) {
        std::string source = kHead + "again:  mov #" + std::to_string(random.below(65536)) +
                             ", w5\n        mov #" + std::to_string(random.below(65536)) +
                             ", w6\n        clr w10\nloop:\n";
        const auto length = random.below(6);
        for (std::uint64_t i = 0; i < length; ++i)
            source += "        " + instruction() + "\n";
        if (random.below(2))
            source += "        " + std::string(random.below(2) ? "dec" : "inc") + " w5, w5\n";
        else
            source += "        add w5, #3, w5\n        cp w5, w6\n";
        source += "        bra " + std::string(conditions[random.below(12)]) + ", loop\n" + kTail;
        const Cycle periods[] = {0, 30'011, 1474, 211};
        compare(source, 150'000, periods[random.below(4)], static_cast<std::uint64_t>(round));
    }
}

TEST_CASE("service routines without a trace are taken in one step, wherever they interrupt") {
    const std::string sources[] = {
        // Polling through calls, words above the stack pointer live and dead, stalls, REPEAT, DISI.
        R"(
again:  mov     #40, w10
loop:   rcall   first
        cp0.b   w0
        bra     nz, done
        rcall   second
        dec     w10, w10
        bra     nz, loop
        bra     done
first:  lnk     #6
        mov     w0, [w14+2]
        mov     #0x0C00, w1
        mov     [w1], w0
        add     w0, #0, w1
        ze      w1, w0
        ulnk
        return
second: lnk     #2
        mov     w12, [w14]
        mov     [w14], w1
        repeat  #5
        inc     w2, w2
        disi    #3
        inc     w3, w3
        ulnk
        return
)",
        R"(
again:  mov     #0x1000, w1
wait:   mov     [w1], w0
        mov     [w15+4], w4
        btst    0x84, #3
        bra     wait
)",
        "again:  bra     again\n",
    };
    for (const auto& source : sources)
        for (const Cycle period : {Cycle{20'011}, Cycle{997}, Cycle{113}, Cycle{85}, Cycle{31}})
            compare(kHead + source + kTracelessTail, 100'000, period, period);
}

TEST_CASE("loops that only wait are skipped together with service routines without a trace") {
    RandomStream random(3, "steady loops");
    const auto pick = [&](std::initializer_list<const char*> choice) -> std::string {
        return choice.begin()[random.below(choice.size())];
    };
    for (int round = 0; round < 150; ++round) {
        // Functions that build frames, look at memory and return what they found.
        std::string functions;
        std::string body = "again:\n";
        const auto calls = 1 + random.below(3);
        for (std::uint64_t i = 0; i < calls; ++i) {
            const std::string name = "f" + std::to_string(i);
            body += "        rcall " + name + "\n";
            if (random.below(2))
                body += "        " + pick({"nop", "mov w0, w4", "push w4\n        pop w5", "clr w6"}) + "\n";
            body += "        cp0.b w0\n        bra nz, done\n";
            functions += name + ":     lnk #" + std::to_string(2 * random.below(5)) + "\n";
            const auto lines = random.below(5);
            for (std::uint64_t line = 0; line < lines; ++line)
                functions += "        " +
                             pick({"mov w1, [w14]", "mov [w14], w2", "mov #0x0C02, w3\n        mov [w3], w2",
                                   "push.d w4\n        nop\n        pop.d w4",
                                   "mov w2, [w15++]\n        mov [--w15], w2", "mov.b w2, [w14+1]",
                                   "add w2, w2, w7", "sub w2, #3, [w15]", "mov [w15+2], w1",
                                   "mov w15, w3\n        mov [w3], w1", "rcall leaf"}) +
                             "\n";
            functions +=
                pick({"        mov 0x0C00, w0\n", "        mov.b 0x0d8, wreg\n", "        clr w0\n"});
            functions += "        ulnk\n        return\n";
        }
        functions += "leaf:   push w8\n        mov #0x0C04, w8\n        mov [w8], w2\n        pop w8\n       "
                     " return\n";
        const Cycle periods[] = {61, 85, 113, 331, 1474};
        compare_steady(kHead + "        mov #0x0020, w0\n        mov w0, 0x0C00\n        clr 0x0C00\n" +
                           body + "        bra again\n" + functions + kTracelessTail,
                       60'000, periods[random.below(5)], static_cast<std::uint64_t>(round));
    }
}

TEST_CASE("service routines of any instructions are taken in one step only where that is exact") {
    RandomStream random(4, "service routines");
    const auto pick = [&](std::initializer_list<const char*> choice) -> std::string {
        return choice.begin()[random.below(choice.size())];
    };
    for (int round = 0; round < 200; ++round) {
        std::string isr = "isr:    push.d w0\n        push.d w2\n        lnk #" +
                          std::to_string(2 * random.below(4)) + "\n";
        const auto lines = 1 + random.below(5);
        for (std::uint64_t line = 0; line < lines; ++line)
            isr += "        " +
                   pick({"mov #2, w0\n        mov w0, 0x0da",
                         "mov #0x0DA, w1\n        mov #2, w2\n        mov w2, [w1]",
                         "mov #6, w0\n        and w0, #3, w0\n        mov w0, 0x0da",
                         "mov w4, [w15++]\n        mov [--w15], w3",
                         "mov #5, w0\n        bset w0, #4\n        btss w0, #4\n        inc w13, w13",
                         "rcall leaf",
                         "mov #1, w2\n        sl w2, #1, w2\n        mov w2, 0x0da",
                         "mov w15, w2\n        mov w3, [w2]",
                         "mov w5, [w14]\n        mov [w14], w2",
                         "mov [w14-2], w3",
                         "mov [w15-14], w3",
                         "mov #3, w0\n        mov.b wreg, 0x0da",
                         "add w0, #1, w0",
                         "mov #7, w1\n        exch w1, w2",
                         "mov #0x1234, w0\n        swap w0",
                         "clr w0\n        mov w0, [w15]",
                         "clrwdt",
                         "mov 0x0da, w0",
                         "bset 0x0da, #1",
                         "mov #4, w1\n        mul.uu w1, #3, w2",
                         "bra skip",
                         "setm w1\n        nop"}) +
                   "\n";
        if (isr.find("bra skip") != std::string::npos) isr += "        mov #9, w0\nskip:\n";
        if (isr.find("bra skip") != isr.rfind("bra skip")) continue;
        isr += "        bclr 0x84, #3\n        ulnk\n        pop.d w2\n        pop.d w0\n        retfie\n"
               "leaf:   lnk #2\n        mov w1, [w14]\n        ulnk\n        return\n";
        const std::string loop =
            "again:  mov #0x0C00, w1\nwait:   mov [w1], w0\n        cp0 w0\n        bra nz, done\n"
            "        bra wait\ndone:   inc w12, w12\n        bra again\n";
        const Cycle periods[] = {61, 113, 331, 1474};
        compare_steady(kHead + "        mov #2, w0\n        mov w0, 0x0da\n        clr 0x0C00\n" + loop + isr,
                       40'000, periods[random.below(4)], static_cast<std::uint64_t>(round));
    }
}

TEST_CASE("waiting under a steady beat really is skipped") {
    Rig rig(kHead + "again:  rcall look\n        cp0.b w0\n        bra z, again\n        bra done\n" +
            "look:   lnk #2\n        mov.b 0x0d8, wreg\n        ulnk\n        return\n" + kTracelessTail);
    rig.sfr.claim(kPolled);
    rig.sfr.claim(kRefreshed);
    rig.sfr.raw(kRefreshed) = 2;
    rig.core.observer().on_interrupt = nullptr;
    rig.vector(kTrapVectors + kT1, "isr");
    const SteadyTicker ticker(rig, 85, 1);
    rig.events.cancel(ticker.change);
    rig.core.run(2'000'000'000);
    CHECK(rig.core.cycle() >= 2'000'000'000);  // would take twenty seconds if executed
    CHECK(rig.core.instructions() > 1'000'000'000);
}

TEST_CASE("after a disturbance a waiting loop has to come round once before it is skipped") {
    // W5 follows W4 an iteration late.
    const std::string source = kHead + R"(
again:  push    w4
        pop     w5
        rcall   look
        mov     w0, w4
        cp0.b   w0
        bra     nz, done
        bra     again
look:   lnk     #8
        mov     w1, [w14]
        mov.b   0x0d8, wreg
        ulnk
        return
)" + kTracelessTail;
    for (std::uint64_t seed = 0; seed < 60; ++seed)
        compare_steady(source, 60'000, seed % 2 ? 1474 : 113, seed);
}
