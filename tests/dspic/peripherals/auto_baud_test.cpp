// UART: auto-baud through input capture, wake-up from Sleep, address detection, loopback.

#include "tests/dspic/chip30_bench.h"
#include "tests/dspic/chip33_bench.h"

#include <catch2/catch.hpp>

#include <cmath>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using cosim::Time;

namespace {

/// Hands in a character of a line at `rate` whose start bit begins at `start`, when its stop bit does.
void receive(Chip& chip, int unit, std::uint16_t data, double rate, Time start, int bits = 8) {
    cosim::UartFrame frame;
    frame.start = start;
    frame.bit_period = static_cast<Time>(std::llround(1e12 / rate));
    frame.data = data;
    frame.data_bits = static_cast<std::uint8_t>(bits);
    chip.run_until(start + (bits + 1) * frame.bit_period);
    chip.uart_receive(unit, frame);
}

}  // namespace

TEST_CASE("ABAUD leads U1RX to IC1: the bit length of 0x55 is that between falling edges (fact sheet 1)") {
    for (const double rate : {9600.0, 57600.0, 115200.0}) {
        CAPTURE(rate);
        Bench30 bench(R"(
        .org 0x200
main:   setm PR3
        mov #0x8000, w0
        mov w0, T3CON
        mov #7, w0
        mov w0, U1BRG
        mov #0x8020, w0                 ; UARTEN, ABAUD
        mov w0, U1MODE
        mov #0x0062, w0                 ; falling edges, an interrupt on every fourth
        mov w0, IC1CON
wait:   btss IFS0, #1
        bra wait
        mov IC1BUF, w2
        mov IC1BUF, w3
        mov IC1BUF, w4
        mov IC1BUF, w5
        sub w5, w2, w6
        mov w6, 0x1000
read:
)");
        bench.run_to("wait");
        receive(bench.chip, 1, 0x55, rate, bench.chip.now() + cosim::kMillisecond);
        bench.run_to("read");
        const double bits = bench.word(0x1000) / (14'745'600.0 / rate);
        CHECK(bits == Approx(6.0).margin(2.5 * rate / 14'745'600.0));  // start, bits 1, 3 and 5
    }
}

TEST_CASE("WAKE ends Sleep by a start bit, with UxRXIF and without the character (DS70061 19)") {
    for (const int wake : {0, 0x80}) {
        CAPTURE(wake);
        Bench30 bench(R"(
        .org 0x200
main:   mov #7, w0
        mov w0, U1BRG
        mov #0x8000 + )" +
                      std::to_string(wake) + R"(, w0
        mov w0, U1MODE
        bclr IFS0, #9
        bset IEC0, #9
        mov #0xe0, w0
        mov w0, SR
sleep:  pwrsav #0
        inc 0x1000
woken:  bra woken
)");
        bench.run_to("sleep");
        receive(bench.chip, 1, 0x41, 115200, bench.chip.now() + cosim::kMillisecond);
        bench.chip.run_until(bench.chip.now() + cosim::kMillisecond);
        CHECK(((bench.reg("RCON") & 8) != 0));
        CHECK(bench.word(0x1000) == (wake ? 1 : 0));
        CHECK(((bench.reg("IFS0") & 0x200) != 0) == (wake != 0));
        CHECK((bench.reg("U1STA") & 1) == 0);
    }
}

TEST_CASE("address detection: only words with the ninth bit are heard (DS70060 19.6)") {
    Bench30 bench(R"(
        .org 0x200
main:   mov #7, w0
        mov w0, U2BRG
        mov #0x8006, w0                 ; nine bits
        mov w0, U2MODE
        bset U2STA, #5                  ; ADDEN
ready:  bra ready
)");
    bench.run_to("ready");
    Time start = cosim::kMillisecond;
    for (const int data : {0x041, 0x143, 0x042}) {
        receive(bench.chip, 2, static_cast<std::uint16_t>(data), 115200, start, 9);
        start += cosim::kMillisecond;
    }
    bench.chip.run_until(start);
    CHECK((bench.reg("U2STA") & 1) == 1);
    CHECK(bench.reg("U2RXREG") == 0x143);
    CHECK((bench.reg("IFS1") & 0x100) == 0x100);
    CHECK(bench.chip.uart_counters(2).received == 3);
}

TEST_CASE("loopback hears itself and neither sends nor hears the line") {
    Bench30 bench(R"(
        .org 0x200
main:   mov #7, w0
        mov w0, U1BRG
        mov #0x8040, w0
        mov w0, U1MODE
        bset U1STA, #10
        mov #0x5a, w0
        mov w0, U1TXREG
ready:  bra ready
)");
    bench.run_to("ready");
    receive(bench.chip, 1, 0x33, 115200, 20 * cosim::kMicrosecond);
    bench.chip.run_until(cosim::kMillisecond);
    CHECK(bench.reg("U1RXREG") == 0x5A);
    CHECK(bench.chip.uart_counters(1).received == 1);
    CHECK(bench.pins.frames.empty());
}

TEST_CASE("33FJ: ABAUD sets UxBRG from 0x55 and clears itself, WAKE swallows a character and clears itself") {
    Bench33 bench(R"(
        .org 0x200
main:   mov #0x8020, w0
        mov w0, U1MODE
ready:  bra ready
)");
    bench.run_to_label("ready");
    bench.chip.set_stops({});
    const double fcy = bench.chip.clock().hertz();
    const double rate = 9600;
    receive(bench.chip, 1, 0x41, rate, 10 * cosim::kMillisecond);  // not the pattern
    CHECK((bench.chip.peek("U1MODE") & 0x20) == 0x20);
    receive(bench.chip, 1, 0x55, rate, 20 * cosim::kMillisecond);
    CHECK((bench.chip.peek("U1MODE") & 0x20) == 0);
    CHECK(bench.chip.peek("U1BRG") == Approx(fcy / 16 / rate - 1).margin(1.0));
    receive(bench.chip, 1, 0x41, fcy / 16 / (bench.chip.peek("U1BRG") + 1), 30 * cosim::kMillisecond);
    bench.chip.run_until(40 * cosim::kMillisecond);
    CHECK(bench.chip.peek("U1STA") == 0x0111);
    CHECK(bench.chip.peek("U1RXREG") == 0x41);
}
