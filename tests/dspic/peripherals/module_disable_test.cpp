// PMDx takes modules away: silent, deaf, read as 0, and new when they come back.

#include "emu/dspic/machine/sfr_space.h"
#include "tests/dspic/chip30_bench.h"
#include "tests/dspic/chip33_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const std::string kTimerProgram = R"(
        .org 0x1a
        .pword timer
        .org 0x200
main:   mov #0x0900, w15
        mov #0x27f0, w0
        mov w0, SPLIM
        mov #999, w0
        mov w0, PR1
        bset IEC0, #3
        mov #0x8000, w0
        mov w0, T1CON
loop:   btss PORTF, #0
        bra loop
        bset PMD1, #11
off:    mov #123, w0
        mov w0, PR1
        mov PR1, w1
        mov w1, 0x1002
gone:   btsc PORTF, #0
        bra gone
        bclr PMD1, #11
        mov #0x8000, w0
        mov w0, T1CON
back:   bra back
timer:  bclr IFS0, #3
        inc 0x1000
        retfie
)";

}  // namespace

TEST_CASE("a timer whose PMD bit is set stops, ignores writes and reads 0, it comes back as after a reset") {
    Bench30 bench(kTimerProgram);
    bench.set(PortLetter::F, 0, true, 10'050);
    CHECK(bench.word(0x1000) == 10);
    bench.run_to("gone");
    CHECK(bench.word(0x1002) == 0);
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    bench.chip.state(writer);
    bench.go(50'000);
    CHECK(bench.word(0x1000) == 10);
    bench.set(PortLetter::F, 0, false, 50'000);
    bench.run_to("back");
    CHECK(bench.reg("PR1") == 0xFFFF);
    CHECK(bench.chip.report().unmodelled.empty());
    bench.go(bench.chip.cycle() + 70'000);
    CHECK(bench.word(0x1000) == 11);  // a period of 65 536

    Bench30 again(kTimerProgram);  // saved while the timer was away
    StateReader reader(bytes);
    again.chip.state(reader);
    again.pins.outside = bench.pins.outside;
    again.pins.outside[5] = 1;
    again.go(60'000);
    again.chip.inside().sfr.write(0x102, 77, 0xFFFF);
    CHECK(again.reg("PR1") == 0);
    CHECK(again.word(0x1000) == 10);
    again.pins.outside[5] = 0;
    again.chip.mclr();
    again.go(60'100);
    CHECK(again.reg("PMD1") == 0);
    CHECK(again.reg("PR1") == 999);
}

TEST_CASE("every PMD bit of a module with a model takes all of its registers away and gives them back") {
    for (const DeviceInfo* device : devices()) {
        Pins30 pins;
        Chip chip(*device, pins, {});
        chip.power_on();
        chip.run_until(cosim::kMicrosecond);
        SfrSpace& sfr = chip.inside().sfr;
        int modules = 0;
        for (const char* pmd : {"PMD1", "PMD2", "PMD3"}) {
            const RegisterInfo* info = sfr.find(pmd);
            if (!info) continue;
            for (int bit = 0; bit < 16; ++bit) {
                if (!(info->implemented >> bit & 1)) continue;
                std::map<std::uint16_t, std::uint16_t> before;
                for (const RegisterInfo& other : device->registers)
                    before[other.address] = sfr.raw(other.address);
                sfr.write(info->address, static_cast<std::uint16_t>(1u << bit), 0xFFFF);
                int silent = 0;
                for (const RegisterInfo& other : device->registers)
                    if (other.address != info->address && sfr.acts(other.address) &&
                        before[other.address] != 0 && sfr.quiet(other.address) &&
                        sfr.quiet_read(other.address) == 0)
                        ++silent;
                sfr.write(info->address, 0, 0xFFFF);
                modules += silent > 0;
                for (const RegisterInfo& other : device->registers)
                    if (other.address >= 0x100 && !other.name.starts_with("PORT") &&
                        !other.name.starts_with("TMR"))
                        CHECK(sfr.raw(other.address) == before[other.address]);
            }
        }
        CHECK(modules > 5);  // those with a register that is not 0 after a reset
    }
}

TEST_CASE("a UART without a clock gives its pins back and does not send") {
    Bench30 bench(R"(
        .org 0x200
main:   mov #7, w0
        mov w0, U1BRG
        mov #0x8000, w0
        mov w0, U1MODE
        bset U1STA, #10
on:     nop
        bset PMD1, #5
        mov #0x41, w0
        mov w0, U1TXREG
ready:  bra ready
)");
    bench.run_to("on");
    CHECK((bench.pins.driven_now[5] & 8) == 8);
    bench.go(50'000);
    CHECK((bench.pins.driven_now[5] & 8) == 0);
    CHECK(bench.pins.frames.empty());
    CHECK_FALSE(bench.chip.uart_enabled(1));
}
