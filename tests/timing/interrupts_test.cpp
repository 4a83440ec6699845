// Interrupts, timed by programs: docs/timing_rules.md, rules X1 and X3.

#include "tests/timing/timed_chip.h"

#include "base/random.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const DeviceInfo* const kDevices[] = {&dspic30f6014a(), &dspic33fj256gp710()};

/// Instructions of one and two cycles, straight on, and how long they take.
struct Straight {
    std::string text;
    int cycles = 0;
};

/// Of the first `kinds` kinds: three take one cycle.
Straight straight(RandomStream& random, int count, std::size_t kinds) {
    static const std::pair<const char*, int> kKinds[] = {
        {"nop", 1},          {"inc w6, w6", 1}, {"mul.uu w4, w5, w6", 1},
        {"mov.d w4, w6", 2}, {"bra", 2},        {"tblrdl [w8], w6", 2}};
    Straight all;
    for (int i = 0; i < count; ++i) {
        const auto& [text, cycles] = kKinds[random.next() % kinds];
        if (std::string(text).starts_with("bra"))
            all.text += fmt::format("        bra s{0}\ns{0}:\n", i);
        else
            all.text += fmt::format("        {}\n", text);
        all.cycles += cycles;
    }
    return all;
}

/// Timer2 interrupts once, `wait` counts after it was started; the routine takes down TMR2, the program TMR1
/// at the begin and the end of straight code.
std::string one_interrupt(const DeviceInfo& device, int wait, const Straight& code) {
    return fmt::format(R"(
        goto    main
        .org    {:#x}
        .pword  isr
        .org    0x200
isr:    mov     TMR2, w10
        clr     T2CON
        bclr    IFS0, #{}
        retfie
main:   mov     #{:#x}, w15
        mov     #0x1400, w8
        clr     w10
        setm    PR1
        mov     #0x8000, w0
        mov     w0, T1CON
        bset    IEC0, #{}
        mov     #{}, w1
        mov     w1, PR2
        mov     w0, T2CON
        mov     TMR1, w11
{}
        mov     TMR1, w12
        mov     w10, 0x1314
        mov     w11, 0x1316
        mov     w12, 0x1318
end:    bra     end
)",
                       device.ivt + 2 * (kTrapVectors + (device.family_33f ? 7 : 6)),
                       device.family_33f ? 7 : 6, device.ram_start + 0x200, device.family_33f ? 7 : 6, wait,
                       code.text);
}

/// What the program has stored of a register at its end.
int register_of(TimedChip& run, int w) {
    return run.word(0x1300 + 2 * w);
}

}  // namespace

TEST_CASE(
    "the first instruction of a handler runs in the fifth cycle after the flag's, whatever was under way") {
    RandomStream random(Catch::rngSeed(), "latency");
    for (const DeviceInfo* device : kDevices)
        for (int i = 0; i < 40; ++i) {
            const Straight code = straight(random, 120, i % 2 ? 6 : 3);
            const int wait = 10 + static_cast<int>(random.next() % 90);
            TimedChip run(*device, one_interrupt(*device, wait, code));
            run.run_to("end");
            INFO(device->name << ", " << wait << " counts\n" << code.text);
            // TMR2 is 0 in the flag's cycle.
            CHECK(register_of(run, 10) == 5);
            // Four cycles to get there (three if the flag came in the first of two cycles, for the latency is
            // the same), the routine's three of one cycle, three of RETFIE.
            const int entry = register_of(run, 12) - register_of(run, 11) - (1 + code.cycles + 3 + 3);
            CHECK((entry == 4 || (entry == 3 && i % 2)));
        }
}

TEST_CASE("DISI #n holds interrupts for n cycles and its own") {
    RandomStream random(Catch::rngSeed(), "disi");
    for (const DeviceInfo* device : kDevices)
        for (int i = 0; i < 10; ++i) {
            const int held = 3 + static_cast<int>(random.next() % 200);
            // The flag is set by software in the first cycle behind DISI.
            const std::string source = fmt::format(
                R"(
        goto    main
        .org    {:#x}
        .pword  isr
        .org    0x200
isr:    mov     TMR1, w11
        mov     w10, 0x1314
        mov     w11, 0x1316
end:    bra     end
main:   mov     #{:#x}, w15
        setm    PR1
        mov     #0x8000, w0
        mov     w0, T1CON
        bset    IEC0, #{}
        mov     TMR1, w10
        disi    #{}
        bset    IFS0, #{}
        repeat  #400
        nop
stay:   bra     stay
)",
                device->ivt + 2 * (kTrapVectors + (device->family_33f ? 7 : 6)), device->ram_start + 0x200,
                device->family_33f ? 7 : 6, held, device->family_33f ? 7 : 6);
            TimedChip run(*device, source);
            run.run_to("end");
            INFO(device->name << ", DISI #" << held);
            // DISI begins a cycle behind the reading; n + 1 cycles later the flag counts, with a flag's
            // latency.
            CHECK(register_of(run, 11) - register_of(run, 10) == 1 + held + 1 + 5);
        }
}

TEST_CASE("RETFIE takes 2 cycles where the next exception is pending, which begins 4 later, else 3") {
    RandomStream random(Catch::rngSeed(), "chained");
    for (const DeviceInfo* device : kDevices)
        for (int i = 0; i < 10; ++i) {
            // Both flags stand before either may be taken. The first routine's last word is TMR1, the
            // second's first one, and the program's first one behind it.
            const int first = device->family_33f ? 7 : 6, second = device->family_33f ? 8 : 7;
            const Straight code = straight(random, 1 + static_cast<int>(random.next() % 20), 6);
            const std::string source = fmt::format(R"(
        goto    main
        .org    {0:#x}
        .pword  one, two
        .org    0x200
one:    bclr    IFS0, #{1}
{4}
        mov     TMR1, w10
        retfie
two:    mov     TMR1, w11
        bclr    IFS0, #{2}
        mov     TMR1, w12
        retfie
main:   mov     #{3:#x}, w15
        mov     #0x1400, w8
        setm    PR1
        mov     #0x8000, w0
        mov     w0, T1CON
        bset    IEC0, #{1}
        bset    IEC0, #{2}
        disi    #10
        bset    IFS0, #{1}
        bset    IFS0, #{2}
        clr     w0
wait:   inc     w0, w0
        btss    w0, #3
        bra     wait
        mov     TMR1, w13
        mov     w10, 0x1314
        mov     w11, 0x1316
        mov     w12, 0x1318
end:    bra     end
)",
                                                   device->ivt + 2 * (kTrapVectors + first), first, second,
                                                   device->ram_start + 0x200, code.text);
            TimedChip run(*device, source);
            run.run_to("end");
            INFO(device->name << "\n" << code.text);
            CHECK(register_of(run, 11) - register_of(run, 10) == 1 + 2 + 4);
        }
}
