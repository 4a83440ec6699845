#include "emu/dspic/peripherals/serial/uart.h"
#include "protocols/serial/uart_sampling.h"

#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using cosim::Time;
using cosim::UartFrame;

namespace {

constexpr std::uint16_t kEnable = 0x8000;
constexpr std::uint16_t kUtxen = 0x0400;
constexpr std::uint16_t kUtxisel = 0x8000;
constexpr std::uint16_t kUtxbf = 0x0200;
constexpr std::uint16_t kTrmt = 0x0100;
constexpr std::uint16_t kUtxbrk = 0x0800;
constexpr std::uint16_t kPerr = 0x8, kFerr = 0x4, kOerr = 0x2, kUrxda = 0x1, kRidle = 0x10;
constexpr std::uint16_t kBrg = 7;   // 115,200 baud
constexpr Cycle kFrame = 10 * 128;  // 8N1
constexpr Cycle kBeforeStop = 9 * 128;

struct UartBench : Bench {
    Ports ports{around, layout_dspic30f6014a().ports, pins};
    Uart uart{around, {2, sfr::U2MODE, irq::U2RX, irq::U2TX, PortLetter::F, 4, 5}, clock, ports, pins};

    void enable(std::uint16_t mode = 0, std::uint16_t sta = 0) {
        write(sfr::U2BRG, kBrg);
        write(sfr::U2MODE, kEnable | mode);
        write(sfr::U2STA, kUtxen | sta);
        interrupts.clear(irq::U2TX);
    }
    std::uint16_t sta() { return read(sfr::U2STA); }

    UartFrame frame_at(Time start, std::uint16_t data, double baud) {
        UartFrame frame;
        frame.start = start;
        frame.bit_period = cosim::from_seconds(1.0 / baud);
        frame.data = data;
        return frame;
    }
    /// Sends characters back to back at `baud` from `start` on and returns when the line rests.
    Time feed(Time start, std::initializer_list<int> bytes, double baud) {
        for (const int byte : bytes) {
            const UartFrame frame = frame_at(start, static_cast<std::uint16_t>(byte), baud);
            give(frame);
            start += 10 * frame.bit_period;
        }
        return start;
    }
    void give(const UartFrame& frame) {
        go(clock.first_cycle_at(protocols::stop_bit_start(frame)));
        uart.receive(frame, now);
    }
};

}  // namespace

TEST_CASE_METHOD(UartBench, "a byte leaves as a frame when its stop bit begins") {
    enable();
    CHECK(sta() == (0x0110 | kUtxen));
    go(1000);
    write(sfr::U2TXREG, 0xA5);
    CHECK_FALSE(sta() & kTrmt);
    REQUIRE(uart.begun());
    const Time start = uart.begun()->start;
    CHECK(start >= clock.time_of(1001));
    CHECK(start <= clock.time_of(1001 + 8));
    const Cycle begin = clock.first_cycle_at(start);
    go(begin + kBeforeStop - 1);
    CHECK(pins.frames.empty());
    go(begin + kBeforeStop);
    REQUIRE(pins.frames.size() == 1);
    CHECK(pins.frames[0].data == 0xA5);
    CHECK(pins.frames[0].start == start);
    CHECK(std::abs(static_cast<double>(pins.frames[0].bit_period) - 1e12 / 115200.0) < 2.0);
    CHECK(protocols::stop_bit_start(pins.frames[0]) >= clock.time_of(begin + kBeforeStop));
    CHECK_FALSE(uart.begun());
    CHECK_FALSE(sta() & kTrmt);
    go(begin + kFrame);
    CHECK(sta() & kTrmt);
}

TEST_CASE_METHOD(UartBench,
                 "four words wait behind the one being shifted, a fifth is dropped, frames follow closely") {
    enable();
    for (int i = 0; i < 5; ++i)
        write(sfr::U2TXREG, static_cast<std::uint16_t>(i));
    CHECK(sta() & kUtxbf);
    write(sfr::U2TXREG, 99);
    go(now + 20 * kFrame);
    REQUIRE(pins.frames.size() == 5);
    for (std::size_t i = 0; i < 5; ++i)
        CHECK(pins.frames[i].data == i);
    for (std::size_t i = 1; i < 5; ++i) {
        const double gap = static_cast<double>(pins.frames[i].start - pins.frames[i - 1].start);
        CHECK(std::abs(gap - 10e12 / 115200.0) < 2.0);
    }
}

TEST_CASE_METHOD(UartBench, "UTXISEL chooses between every transfer and the last one") {
    enable();
    for (int i = 0; i < 3; ++i)
        write(sfr::U2TXREG, 1);
    CHECK(take(irq::U2TX));  // the first moved at once
    const Cycle second = until_flag(irq::U2TX, 100000);
    const Cycle third = until_flag(irq::U2TX, 100000);
    CHECK(third - second == kFrame);
    CHECK(until_flag(irq::U2TX, 100000) == kNoCycle);

    go(200000);
    write(sfr::U2STA, kUtxen | kUtxisel);
    for (int i = 0; i < 3; ++i)
        write(sfr::U2TXREG, 1);
    CHECK(take(irq::U2TX));  // the first word emptied the FIFO
    const Cycle last = until_flag(irq::U2TX, 300000);
    CHECK(last == clock.first_cycle_at(pins.frames.back().start) + kFrame);
    CHECK(until_flag(irq::U2TX, 400000) == kNoCycle);
}

TEST_CASE_METHOD(
    UartBench, "the module raises its transmit flag when it is first enabled, and clearing UTXEN drops all") {
    write(sfr::U2MODE, kEnable);
    CHECK(take(irq::U2TX));
    write(sfr::U2TXREG, 7);  // may be loaded before UTXEN
    write(sfr::U2STA, kUtxen);
    CHECK_FALSE(sta() & kTrmt);
    write(sfr::U2STA, 0);
    CHECK(sta() & kTrmt);
    go(now + 10000);
    CHECK(pins.frames.empty());
}

TEST_CASE_METHOD(UartBench, "parity, nine bits and two stop bits are on the wire") {
    enable(2 | 1);  // 8E2
    write(sfr::U2TXREG, 0x07);
    go(now + 20 * kFrame);
    REQUIRE(pins.frames.size() == 1);
    CHECK(pins.frames[0].parity == 2);
    CHECK(pins.frames[0].parity_bit == 1);
    CHECK(pins.frames[0].stop_bits == 2);
    write(sfr::U2MODE, 0);
    enable(4);  // 8O1
    write(sfr::U2TXREG, 0x07);
    go(now + 20 * kFrame);
    CHECK(pins.frames.back().parity_bit == 0);
    write(sfr::U2MODE, 0);
    enable(6);  // 9N1
    write(sfr::U2TXREG, 0x1AA);
    go(now + 20 * kFrame);
    CHECK(pins.frames.back().data == 0x1AA);
    CHECK(pins.frames.back().data_bits == 9);
}

TEST_CASE_METHOD(UartBench, "a received byte shows half a bit after its stop bit began and is read once") {
    enable();
    go(5000);
    const UartFrame frame = frame_at(clock.time_of(5000), 0x5A, 115200.0);
    give(frame);
    CHECK_FALSE(sta() & kUrxda);
    CHECK_FALSE(sta() & kRidle);
    const Cycle seen = until_flag(irq::U2RX, 100000);
    CHECK(seen >= 5000 + kBeforeStop + 64);
    CHECK(seen <= 5000 + kBeforeStop + 64 + 8);
    CHECK(sta() & kUrxda);
    CHECK(sta() & kRidle);
    CHECK(read(sfr::U2RXREG) == 0x5A);
    CHECK_FALSE(sta() & kUrxda);
}

TEST_CASE_METHOD(UartBench, "URXISEL: every word, at three, at four") {
    const auto mode = GENERATE(0, 1, 2, 3);
    enable(0, static_cast<std::uint16_t>(mode << 6));
    const int expected_at[] = {1, 1, 3, 4};
    Time time = clock.time_of(1000);
    for (int i = 1; i <= 4; ++i) {
        time = feed(time, {i}, 115200.0);
        go(clock.first_cycle_at(time));
        CHECK(take(irq::U2RX) == (mode < 2 || i == expected_at[mode]));
    }
}

TEST_CASE_METHOD(UartBench,
                 "a fifth unread word sets OERR, which stays and deafens until software clears it") {
    enable();
    Time time = feed(clock.time_of(1000), {1, 2, 3, 4}, 115200.0);
    go(clock.first_cycle_at(time));
    CHECK_FALSE(sta() & kOerr);
    time = feed(time, {5}, 115200.0);
    go(clock.first_cycle_at(time));
    CHECK(sta() & kOerr);
    for (int i = 1; i <= 4; ++i)
        CHECK(read(sfr::U2RXREG) == i);
    time = feed(time, {6}, 115200.0);
    go(clock.first_cycle_at(time));
    CHECK_FALSE(sta() & kUrxda);  // deaf
    CHECK(sta() & kOerr);
    CHECK(uart.counters().overruns == 2);
    write(sfr::U2STA, static_cast<std::uint16_t>(sta() & ~kOerr));
    time = feed(time, {7}, 115200.0);
    go(clock.first_cycle_at(time));
    CHECK(read(sfr::U2RXREG) == 7);
}

TEST_CASE_METHOD(UartBench, "parity errors and break come with the word they belong to") {
    enable(2);  // 8E1
    UartFrame frame = frame_at(clock.time_of(1000), 0x01, 115200.0);
    frame.parity = 2;
    frame.parity_bit = 0;  // wrong
    give(frame);
    frame.start += 11 * frame.bit_period;
    frame.parity_bit = 1;
    give(frame);
    go(now + 1000);
    CHECK(sta() & kPerr);
    read(sfr::U2RXREG);
    CHECK_FALSE(sta() & kPerr);
    CHECK(read(sfr::U2RXREG) == 1);

    frame.start += 50 * frame.bit_period;
    frame.is_break = 1;
    give(frame);
    const UartFrame longer = [&] {  // the line stays low for another frame: still one break
        UartFrame next = frame;
        next.start += 11 * frame.bit_period;
        return next;
    }();
    give(longer);
    go(now + 2000);
    CHECK(sta() & kFerr);
    CHECK(read(sfr::U2RXREG) == 0);
    CHECK_FALSE(sta() & kUrxda);
}

TEST_CASE_METHOD(UartBench, "a few percent of baud mismatch pass, more do not") {
    enable();
    const double factor = GENERATE(0.96, 0.98, 1.02, 1.04);
    Time time = feed(clock.time_of(1000), {0x55, 0xAA, 0x00, 0xFF}, 115200.0 * factor);
    go(clock.first_cycle_at(time) + kFrame);
    CHECK(uart.counters().framing_errors == 0);
    CHECK(read(sfr::U2RXREG) == 0x55);
    CHECK(read(sfr::U2RXREG) == 0xAA);
    CHECK(read(sfr::U2RXREG) == 0x00);
    CHECK(read(sfr::U2RXREG) == 0xFF);
}

TEST_CASE_METHOD(UartBench, "a receiver four times too fast sees several short characters of garbage") {
    enable();
    // 0x00 at 28,800 baud: 36 low bit times of ours, then high. Nine zeros and a low stop bit are a break;
    // the line must rise before the next start bit.
    const Time time = feed(clock.time_of(1000), {0x00}, 28800.0);
    go(clock.first_cycle_at(time) + kFrame);
    CHECK(uart.counters().received == 1);
    CHECK(uart.counters().framing_errors == 1);
    read(sfr::U2RXREG);
    // 0x55: levels alternate every four of our bits, from the start bit on. Our tenth bit falls on a low
    // one twice; the third character ends on the stop bit.
    const Time after = feed(time + cosim::kMillisecond, {0x55}, 28800.0);
    go(clock.first_cycle_at(after) + 5 * kFrame);  // until no unseen frame could matter
    CHECK((sta() & kFerr) != 0);
    CHECK(read(sfr::U2RXREG) == 0x78);
    CHECK((sta() & kFerr) != 0);
    CHECK(read(sfr::U2RXREG) == 0x78);
    CHECK((sta() & kFerr) == 0);
    CHECK(read(sfr::U2RXREG) == 0xF8);
    CHECK_FALSE(sta() & kUrxda);
}

TEST_CASE_METHOD(UartBench, "a receiver twice too slow merges two characters into one") {
    enable();
    // Ten of our bits are twenty of the sender's; the stop bit of the first character falls on our data bit
    // 3.
    const Time time = feed(clock.time_of(1000), {0x00, 0x00, 0x00, 0x00}, 230400.0);
    go(clock.first_cycle_at(time) + 10 * kFrame);
    CHECK(uart.counters().received == 2);
    CHECK(read(sfr::U2RXREG) == 0x08);
    CHECK(read(sfr::U2RXREG) == 0x08);
}

TEST_CASE_METHOD(UartBench, "loopback brings own words back and keeps the pins quiet") {
    enable(0x40);
    write(sfr::U2TXREG, 0x3C);
    go(now + 2 * kFrame);
    CHECK(pins.frames.empty());
    CHECK(read(sfr::U2RXREG) == 0x3C);
}

TEST_CASE_METHOD(UartBench, "with ADDEN only words with bit 8 set are loaded") {
    enable(6, 0x20);
    UartFrame frame = frame_at(clock.time_of(1000), 0x012, 115200.0);
    frame.data_bits = 9;
    give(frame);
    frame.start += 11 * frame.bit_period;
    frame.data = 0x113;
    give(frame);
    go(now + 1000);
    CHECK(read(sfr::U2RXREG) == 0x113);
    CHECK_FALSE(sta() & kUrxda);
}

TEST_CASE_METHOD(UartBench, "a break is sent as long as UTXBRK stands") {
    enable();
    write(sfr::U2STA, kUtxen | kUtxbrk);
    go(now + 3 * kFrame + 200);
    write(sfr::U2STA, kUtxen);
    go(now + 5 * kFrame);
    CHECK(pins.frames.size() == 4);
    for (const UartFrame& frame : pins.frames)
        CHECK(frame.is_break == 1);
}

TEST_CASE_METHOD(UartBench,
                 "what passes while the UART is off is not heard, nor the rest of a frame begun before") {
    Time time = feed(clock.time_of(1000), {1, 2, 3}, 115200.0);
    const UartFrame cut = frame_at(time, 0xFF, 115200.0);  // its start bit passes unheard, the rest is high
    go(clock.first_cycle_at(time + 3 * cut.bit_period));
    enable();
    give(cut);
    time = feed(time + 20 * cut.bit_period, {0x42}, 115200.0);
    go(clock.first_cycle_at(time));
    CHECK(uart.counters().received == 1);
    CHECK(read(sfr::U2RXREG) == 0x42);
}

TEST_CASE_METHOD(UartBench, "an enabled UART takes its pins") {
    enable();
    REQUIRE_FALSE(pins.drives.empty());
    CHECK((pins.drives.back().driven & 0x30) == 0x20);
    CHECK((pins.drives.back().levels & 0x20) == 0x20);
    write(sfr::U2MODE, 0);
    CHECK((pins.drives.back().driven & 0x30) == 0);
}
