// The dsPIC33FJ256GP710 composed, with small programs of its own: clock switch, timers that zero themselves,
// carrier, A/D handshake, SPI, DMA, self-programming, interrupts.

#include "tests/dspic/chip33_bench.h"
#include "tests/kit/dspic33_pieces.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using cosim::Time;

namespace {

// The clock chain of the range-and-bearing board: 4 MHz crystal, x 82, / 2 / 2 / 2.
const std::string kSwitch = R"(
        .org 0x200
main:   mov #80, w0
        mov w0, PLLFBD
        mov #0x00C0, w1
        com w1, w1
        mov CLKDIV, w0
        and w0, w1, w0
        mov w0, CLKDIV
)" + tests::clock_switch(3) +
                            "asked:  nop\n";
const std::string kWaitForPll = R"(
lock:   mov OSCCON, w0
        mov #0x7000, w1
        and w0, w1, w0
        mov #0x3000, w1
        cp w0, w1
        bra nz, lock
)";

}  // namespace

TEST_CASE("the chip starts on its RC oscillator and switches to the PLL after start-up and lock") {
    Bench33 bench(kSwitch + kWaitForPll + "done: nop\nspin: bra spin\n");
    CHECK(bench.chip.peek("OSCCON") == 0x0000);
    CHECK(bench.chip.clock().hertz() == 3.685e6);
    const Time asked = bench.run_to_label("asked");
    CHECK(bench.chip.peek("OSCCON") == 0x0301);
    const Time done = bench.run_to_label("done");
    CHECK(bench.chip.peek("OSCCON") == 0x3320);
    CHECK(bench.chip.clock().hertz() == 41e6);
    // 1024 crystal periods, 1 ms of lock, 10 cycles.
    CHECK(in_microseconds(done - asked) == Approx(256 + 1000).epsilon(0.005));
    // From here on a thousand cycles last a thousand periods of 41 MHz.
    const Cycle before = bench.chip.cycle();
    bench.chip.run_until(bench.chip.now() + 100 * cosim::kMicrosecond);
    CHECK(bench.chip.cycle() - before == Approx(4100).margin(4));
}

TEST_CASE("OSCCON keeps shut without its keys, with switching off, and to the present source") {
    const std::string shut = "        .org 0x200\nmain: mov #0x743, w1\n mov #3, w4\n mov.b w4, [w1]\n"
                             " mov #0x742, w1\n mov #1, w4\n mov.b w4, [w1]\ndone: bra done\n";
    Bench33 keys(shut);
    keys.run_to_label("done");
    CHECK(keys.chip.peek("OSCCON") == 0x0000);
    Bench33 off(kSwitch + "done: bra done\n", {{0xF80008, 0xFFBD}});  // FCKSM1 = 1
    off.run_to_label("done");
    CHECK(off.chip.peek("OSCCON") == 0x0300);
    Bench33 none(kSwitch + "done: bra done\n", {{0xF80008, 0xFF7F}});  // POSCMD = 3: no primary oscillator
    none.chip.run_until(20 * cosim::kMillisecond);
    CHECK(none.chip.peek("OSCCON") == 0x0301);
}

TEST_CASE("FOSCSEL chooses the clock at power-on") {
    const std::string idle = "        .org 0x200\nmain: bra main\n";
    CHECK(Bench33(idle, {{0xF80006, 0xFFFA}}).chip.clock().hertz() == 2e6);  // primary
    CHECK(Bench33(idle, {{0xF80006, 0xFFFB}}).chip.clock().hertz() ==
          4e6 * 50 / 16);                                                       // with the PLL's defaults
    CHECK(Bench33(idle, {{0xF80006, 0xFFFD}}).chip.clock().hertz() == 16'384);  // LPRC
    CHECK(Bench33(idle, {{0xF80006, 0xFFFE}}).chip.clock().hertz() == 7.37e6 / 32);  // FRC/16
}

TEST_CASE("a timer that its own service routine zeroes has a period longer by the latency") {
    Bench33 bench(R"(
        .org 0x0024
        .pword isr
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        clr TRISB
        mov #0x0FA0, w0
        mov w0, PR3
        bset IEC0, #8
        mov #0x8000, w0
        mov w0, T3CON
wait:   bra wait
isr:    clr TMR3
        btg LATB, #0
        bclr IFS0, #8
        retfie
)");
    bench.chip.run_until(20 * cosim::kMillisecond);
    const auto& edges = bench.pins.edges;
    REQUIRE(edges.size() > 10);
    std::set<Cycle> periods;
    for (std::size_t i = 2; i < edges.size(); ++i)
        periods.insert(edges[i].at - edges[i - 1].at);
    // 4001 counts, the entry, and CLR: 5 or 6 more, as the branch under way has one or two cycles.
    CHECK(*periods.begin() >= 4006);
    CHECK(*periods.rbegin() <= 4008);
}

TEST_CASE("OC1 reports its carrier: mode, period and duty, once a change") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #84, w0
        mov w0, PR2
        mov #42, w0
        mov w0, OC1R
        mov w0, OC1RS
        mov #6, w0
        mov w0, OC1CON
set:    mov #0x8000, w0
        mov w0, T2CON
on:     mov #42, w0
        mov w0, OC1RS
        mov #10, w0
        mov w0, OC1RS
later:  mov OC1R, w1
        repeat #200
        nop
loaded: mov OC1R, w2
        clr T2CON
off:    clr OC1CON
done:   bra done
)");
    bench.run_to_label("set");
    CHECK(bench.chip.output_compare(1) == OutputCompareState{6, false, 85, 42, false});
    bench.run_to_label("on");
    CHECK(bench.chip.output_compare(1) == OutputCompareState{6, true, 85, 42, false});
    bench.run_to_label("later");
    CHECK(bench.chip.output_compare(1).high == 42);  // the period under way keeps its duty
    bench.run_to_label("loaded");
    CHECK(bench.chip.output_compare(1).high == 10);
    bench.run_to_label("off");
    CHECK_FALSE(bench.chip.output_compare(1).running);
    bench.run_to_label("done");
    CHECK(bench.chip.output_compare(1) == OutputCompareState{});
    CHECK(bench.pins.compare_changes == std::vector<int>(5, 1));
    CHECK(bench.chip.output_compare(9) == OutputCompareState{});
}

TEST_CASE("a continuous pulse and a single edge come to the pin and interrupt") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #999, w0
        mov w0, PR2
        mov #100, w0
        mov w0, OC3R
        mov #300, w0
        mov w0, OC3RS
        mov #5, w0
        mov w0, OC3CON
        mov #500, w0
        mov w0, OC4R
        mov #1, w0
        mov w0, OC4CON
        mov #0x8000, w0
        mov w0, T2CON
wait:   bra wait
)");
    bench.chip.run_until(2 * cosim::kMillisecond);
    std::vector<Cycle> rises, falls;
    Cycle single = 0;
    std::uint16_t before = 0;
    for (const auto& edge : bench.pins.port_d) {
        const auto changed = static_cast<std::uint16_t>(edge.levels ^ before);
        if (changed & 4) (edge.levels & 4 ? rises : falls).push_back(edge.at);
        if ((changed & 8) && (edge.levels & 8)) single = edge.at;
        before = edge.levels;
    }
    REQUIRE(rises.size() >= 3);
    CHECK(falls[0] - rises[0] == Approx(200).margin(2));
    CHECK(rises[1] - rises[0] == Approx(1000).margin(2));
    CHECK(single - rises[0] == Approx(400).margin(2));
    CHECK((bench.chip.peek("IFS1") & 0x0600) == 0x0600);  // OC3IF and OC4IF
    CHECK(bench.chip.output_compare(3) ==
          OutputCompareState{5, true, 1000, 200, bench.chip.output_compare(3).level});
}

TEST_CASE(
    "the A/D converter samples, converts in 14 TAD and shows DONE, digital and driven pins are not asked") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #0x84E0, w0
        mov #10, w1
        mov w1, AD1CON3
        mov #31, w1
        mov w1, AD1CHS0
        mov w0, AD1CON1
        bset AD1CON1, #1
start:  btss AD1CON1, #0
        bra start
done:   mov ADC1BUF0, w5
        mov w5, 0x1000
        bset AD1PCFGH, #15
        bset AD1CON1, #1
again:  btss AD1CON1, #0
        bra again
        mov ADC1BUF0, w5
        mov w5, 0x1002
end:    bra end
)");
    bench.pins.volts[31] = 0.25 + 0.5 / 4096;
    bench.run_to_label("start");
    const Cycle start = bench.chip.cycle();
    bench.run_to_label("done");
    CHECK(bench.chip.cycle() - start == Approx(14 * 11).margin(4));
    bench.run_to_label("end");
    CHECK(bench.word(0x1000) == 1024);
    CHECK(bench.word(0x1002) == 0);
    CHECK(bench.pins.asked == std::vector<int>{31});
}

TEST_CASE("a scan with 10 bits walks the selected inputs and DMA stores the results in a row") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #2, w0
        mov w0, AD1CON3
        mov #0x0404, w0      ; scan, interrupt after two
        mov w0, AD1CON2
        mov #0x0011, w0      ; AN0, AN4
        mov w0, AD1CSSL
        mov #0x2, w0         ; AN17
        mov w0, AD1CSSH
        mov #5, w0           ; six transfers
        mov w0, DMA2CNT
        mov #0x0020, w0
        mov w0, DMA2STA
        mov #13, w0          ; AD1
        mov w0, DMA2REQ
        mov #0x300, w0       ; ADC1BUF0
        mov w0, DMA2PAD
        mov #0x8001, w0      ; one shot
        mov w0, DMA2CON
        mov #0x80E4, w0      ; on, counter ends sampling, automatic
        mov w0, AD1CON1
wait:   btss IFS1, #8        ; DMA2IF
        bra wait
done:   bra done
)");
    bench.pins.volts[0] = 0.1;
    bench.pins.volts[4] = 0.5;
    bench.pins.volts[17] = 0.75;
    bench.run_to_label("done");
    for (const int index : {0, 2, 4}) {
        CHECK(bench.word(0x7820 + 2 * index) == 102);
        CHECK(bench.word(0x7822 + 2 * index) == 512);
    }
    CHECK((bench.chip.peek("DMA2CON") & 0x8000) == 0);
    CHECK((bench.chip.peek("IFS0") & 0x2000) != 0);  // AD1IF
    CHECK(bench.chip.peek("DMACS1") == 0x0200);
    CHECK(bench.chip.peek("DSADR") == 0x7820 + 10);
}

TEST_CASE("a program forces DMA transfers to a port in ping-pong") {
    Bench33 bench(R"(
        .org 0x200
main:   clr TRISB
        mov #0x1111, w0
        mov w0, 0x7800
        mov #0x2222, w0
        mov w0, 0x7900
        mov #0x0100, w0
        mov w0, DMA0STB
        mov #0x2CA, w0       ; LATB
        mov w0, DMA0PAD
        mov #0xA002, w0      ; from RAM, continuous ping-pong
        mov w0, DMA0CON
        bset DMA0REQ, #15
        nop
        nop
        nop
first:  nop
        bset DMA0REQ, #15
        nop
        nop
        nop
second: bset DMA0REQ, #15
        nop
        nop
        nop
third:  bra third
)");
    bench.run_to_label("first");
    CHECK(bench.chip.peek("LATB") == 0x1111);
    CHECK((bench.chip.peek("DMACS1") & 0xFF) == 1);
    CHECK((bench.chip.peek("DMA0REQ") & 0x8000) == 0);
    bench.run_to_label("second");
    CHECK(bench.chip.peek("LATB") == 0x2222);
    bench.run_to_label("third");
    CHECK(bench.chip.peek("LATB") == 0x1111);
    CHECK((bench.chip.peek("IFS0") & 0x0010) != 0);
}

TEST_CASE("SPI sends a byte in 8 x 128 cycles and gives what comes in") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #0x0121, w0
        mov w0, SPI1CON1
        mov #0x8000, w0
        mov w0, SPI1STAT
        mov #0x64, w0
        mov w0, SPI1BUF
start:  btss SPI1STAT, #0
        bra start
done:   mov SPI1BUF, w5
        mov w5, 0x1000
        mov #0x11, w0
        mov w0, SPI1BUF
        mov #0x22, w0
        mov w0, SPI1BUF      ; waits in the buffer
        mov #0x33, w0
        mov w0, SPI1BUF      ; dropped
        repeat #3000
        nop
end:    bra end
)");
    bench.pins.spi_answer = 0xA7;
    bench.run_to_label("start");
    const Cycle start = bench.chip.cycle();
    bench.run_to_label("done");
    CHECK(bench.chip.cycle() - start == Approx(8 * 128).margin(4));
    bench.run_to_label("end");
    CHECK(bench.word(0x1000) == 0xA7);
    CHECK(bench.pins.spi_sent == std::vector<int>{0x64, 0x11, 0x22});
    CHECK((bench.chip.peek("SPI1STAT") & 0x41) == 0x41);  // the second answer was never fetched: overflow
    CHECK((bench.chip.peek("IFS0") & 0x0600) == 0x0600);
}

TEST_CASE("port B reads 0 at analog pins, so that a byte-wide BSET of the port clears its neighbours") {
    Bench33 bench(R"(
        .org 0x200
main:   clr TRISB
        mov #0x0081, w0
        mov w0, LATB
        bset.b 0x2C8, #2
first:  setm AD1PCFGL
        setm AD2PCFGL
        bset.b 0x2C8, #3
second: bclr AD2PCFGL, #3
third:  bra third
)");
    bench.run_to_label("first");
    CHECK(bench.chip.peek("LATB") == 0x0004);
    bench.run_to_label("second");
    CHECK(bench.chip.peek("LATB") == 0x000C);
    CHECK(bench.chip.peek("PORTB") == 0x000C);
    bench.run_to_label("third");
    CHECK(bench.chip.peek("PORTB") == 0x0004);  // analog for the second converter
}

TEST_CASE("an open-drain output pulls down and lets go") {
    Bench33 bench(R"(
        .org 0x200
main:   bset ODCD, #4
        bset LATD, #4
        bclr TRISD, #4
high:   bclr LATD, #4
low:    bra low
)");
    bench.run_to_label("high");
    CHECK((bench.pins.driven_d & 0x10) == 0);
    bench.run_to_label("low");
    CHECK((bench.pins.driven_d & 0x10) == 0x10);
    CHECK((bench.pins.port_d.back().levels & 0x10) == 0);
}

TEST_CASE("a page is erased, a row and a word are programmed, and the code changes under the program") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        mov #0x0001, w0
        mov w0, TBLPAG
        mov #0x0400, w6
        tblwtl w0, [w6]      ; the page's address
        mov #0x4042, w0
        rcall go
        mov #0, w1
        mov #64, w2
        mov #0x0400, w6
fill:   mov w1, w3
        tblwtl w3, [w6]
        tblwth w1, [w6++]
        inc w1, w1
        dec w2, w2
        bra nz, fill
        mov #0x4001, w0
        rcall go
        mov #0x04A0, w6
        mov #0xBEEF, w3
        tblwtl w3, [w6]
        mov #0x12, w3
        tblwth w3, [w6]
        mov #0x4003, w0
        rcall go
        mov #0x0402, w6
        tblrdl [w6], w5
        mov w5, 0x1000
        tblrdh [w6], w5
        mov w5, 0x1002
        mov #0x04A0, w6
        tblrdl [w6], w5
        mov w5, 0x1004
        mov #0x0480, w6
        tblrdl [w6], w5
        mov w5, 0x1006
end:    bra end
go:     mov w0, NVMCON
        mov #0x55, w7
        mov w7, NVMKEY
        mov #0xAA, w7
        mov w7, NVMKEY
        bset NVMCON, #15
        nop
        nop
        return
)");
    bench.chip.load_word(0x010402, 0x333333);
    bench.run_to_label("end");
    CHECK(bench.word(0x1000) == 1);
    CHECK(bench.word(0x1002) == 1);
    CHECK(bench.word(0x1004) == 0xBEEF);
    CHECK(bench.word(0x1006) == 0xFFFF);
    CHECK((bench.chip.peek("NVMCON") & 0xA000) == 0);
}

TEST_CASE("INTTREG shows level and number of the interrupt taken, and BRGH makes bits four clocks long") {
    Bench33 bench(R"(
        .org 0x0050
        .pword isr
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        mov #9, w0
        mov w0, U2BRG
        mov #0x8008, w0
        mov w0, U2MODE
        mov #0x0400, w0
        mov w0, U2STA
        bset IEC1, #14
        mov #0x41, w0
        mov w0, U2TXREG
wait:   bra wait
isr:    mov U2RXREG, w5
        mov w5, 0x1000
        bclr IFS1, #14
taken:  retfie
)");
    bench.chip.run_until(200 * cosim::kMicrosecond);
    REQUIRE(bench.pins.frames.size() == 1);
    const cosim::UartFrame frame = bench.pins.frames[0];
    CHECK(static_cast<double>(frame.bit_period) == Approx(40 / 3.685e6 * 1e12).epsilon(1e-6));
    cosim::UartFrame back = frame;
    back.start = bench.chip.now();
    back.data = 0x5A;
    bench.chip.run_until(back.start + 9 * back.bit_period);
    bench.chip.uart_receive(2, back);
    bench.run_to_label("taken");
    CHECK(bench.chip.peek("INTTREG") == (4 << 8 | 30));
    CHECK(bench.word(0x1000) == 0x5A);
    CHECK((bench.chip.peek("IFS1") & 0x8000) == 0x8000);  // the transmitter asks for more
}

TEST_CASE("programming a configuration word outside of configuration space fails") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #0x0001, w0
        mov w0, TBLPAG
        mov #0x0400, w6
        tblwtl w0, [w6]
        mov #0x4000, w0
        mov w0, NVMCON
        mov #0x55, w7
        mov w7, NVMKEY
        mov #0xAA, w7
        mov w7, NVMKEY
        bset NVMCON, #15
        nop
end:    bra end
)");
    bench.run_to_label("end");
    CHECK((bench.chip.peek("NVMCON") & 0xE000) == 0x6000);  // WREN, WRERR, not busy
}

TEST_CASE("NVMCON outlives every reset but power-on, one in mid-operation ends it with WRERR (DS70286)") {
    Bench33 bench(R"(
        .org 0x200
main:   btss NVMCON, #14                ; WREN: this is behind a reset
        bra first
        mov NVMCON, w10
again:  bra again
first:  mov #0x0000, w0
        mov w0, TBLPAG
        mov #0x4000, w6
        tblwtl w0, [w6]
        mov #0x4042, w0                 ; WREN, erase a page
        mov w0, NVMCON
idle:   mov #0x55, w7
        mov w7, NVMKEY
        mov #0xAA, w7
        mov w7, NVMKEY
        bset NVMCON, #15
        nop
end:    bra end
)");
    SECTION("in mid-operation") {
        bench.run_to_label("idle");
        bench.chip.run_until(bench.chip.now() + 200 * cosim::kMicrosecond);
        REQUIRE((bench.chip.peek("NVMCON") & 0xE000) == 0xC000);
        bench.chip.mclr();
        bench.run_to_label("again");
        CHECK(bench.chip.peek("NVMCON") == 0x6042);
    }
    SECTION("behind it") {
        bench.run_to_label("end");
        bench.chip.mclr();
        bench.run_to_label("again");
        CHECK(bench.chip.peek("NVMCON") == 0x4042);
    }
}

TEST_CASE("a part without a program at the reset vector is warned of") {
    Pins33 pins;
    Chip chip(dspic33fj256gp710(), pins);
    chip.power_on();
    REQUIRE(chip.report().warnings.size() == 1);
    CHECK(chip.report().warnings[0].text.find("reset vector") != std::string::npos);
}
