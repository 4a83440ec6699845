// Between the UARTs of two dsPIC33FJ and their lines: polarity, infra-red pulses, flow control by UxCTS and
// UxRTS, as firmware sets them. Levels against a reference receiver: framing/uart_polarity_test.cpp.

#include "base/states/archive.h"
#include "emu/dspic/assembler/assembler.h"
#include "emu/dspic/chip/chip.h"
#include "protocols/serial/uart_sampling.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <vector>

using namespace puckloop;
using namespace puckloop::dspic;
using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Time;

namespace {

constexpr unsigned kEnable = 0x8000, kIren = 0x1000, kRtsmd = 0x0800, kUenRts = 0x0100, kUenBoth = 0x0200,
                   kLpback = 0x40, kUrxinv = 0x10;
constexpr unsigned kUtxinv = 0x4000, kUtxen = 0x0400;
constexpr int kCts = 14, kRts = 15, kTx = 3;  ///< RD14, RD15, RF3
constexpr int kBrg = 1;                       ///< 115,156 baud of 3.685 MHz
constexpr Time kFrame = 87 * kMicrosecond;

struct LinePins : Pins {
    std::map<PortLetter, std::uint16_t> outside, own, drives;
    std::vector<cosim::UartFrame> frames;

    void driven(PortLetter port, std::uint16_t levels, std::uint16_t driven, Cycle) override {
        own[port] = levels;
        drives[port] = driven;
    }
    std::uint16_t levels(PortLetter port, Cycle) override {
        return outside.contains(port) ? outside[port] : std::uint16_t{0xFFFF};
    }
    double analog(int, Cycle) override { return 0; }
    void uart_sent(int, const cosim::UartFrame& frame) override { frames.push_back(frame); }
    void i2c_phase(int, const cosim::I2cPhase&) override {}

    /// An output of port D; nullopt: the pin is an input.
    std::optional<bool> out(PortLetter port, int bit) {
        if (!(drives[port] >> bit & 1)) return std::nullopt;
        return own[port] >> bit & 1;
    }
};

struct End {
    LinePins pins;
    Chip chip;

    explicit End(const std::string& source, const DeviceInfo& device = dspic33fj256gp710())
        : chip(device, pins,
               device.family_33f ? ChipOptions{4e6, 0.0} : ChipOptions{.fosc = std::uint16_t{0xFFE6}}) {
        AssembleOptions options;
        for (const RegisterInfo& info : device.registers)
            options.predefined[std::string(info.name)] = info.address;
        for (const auto& [address, word] :
             assemble("        goto main\n        .org 0x200\n" + source, options).words)
            chip.load_word(address, word);
        chip.power_on();
    }
    int word(int address) { return chip.peek_data(static_cast<std::uint16_t>(address)); }
    void set_cts(bool high) {
        pins.outside[PortLetter::D] = high ? 0xFFFF : 0xBFFF;
        chip.pins_changed(PortLetter::D);
    }
    bool cts() {
        return pins.outside.contains(PortLetter::D) ? pins.outside[PortLetter::D] >> kCts & 1 : true;
    }
    int sent_words() const {
        return static_cast<int>(
            std::count_if(pins.frames.begin(), pins.frames.end(), [](const auto& f) { return !f.is_break; }));
    }
};

/// Sends 0x41, 0x42 and so on to 0x41 + `count` - 1 as fast as the FIFO takes them.
std::string sender(unsigned mode, unsigned sta, int count) {
    return fmt::format(R"(
main:   mov     #0x0900, w15
        mov     #{}, w0
        mov     w0, U1BRG
        mov     #{:#x}, w0
        mov     w0, U1MODE
        mov     #{:#x}, w0
        mov     w0, U1STA
        repeat  #2000           ; 0.5 ms at rest
        nop
        mov     #0x41, w1
        mov     #{}, w2
next:   btsc    U1STA, #9
        bra     next
        mov     w1, U1TXREG
        inc     w1, w1
        dec     w2, w2
        bra     nz, next
stay:   bra     stay
)",
                       kBrg, mode | kEnable, sta | kUtxen, count);
}

/// Keeps what comes in from 0x1000 on, with FERR and PERR above, `pause` cycles between two looks; the count
/// at 0x0A00, OERR at 0x0A02.
std::string receiver(unsigned mode, int pause) {
    return fmt::format(R"(
main:   mov     #0x0900, w15
        mov     #{}, w0
        mov     w0, U1BRG
        mov     #{:#x}, w0
        mov     w0, U1MODE
        mov     #0x1000, w4
        clr     0x0A00
        clr     0x0A02
look:   repeat  #{}
        nop
        btsc    U1STA, #1
        setm    0x0A02
        btss    U1STA, #0
        bra     look
        mov     U1STA, w1
        mov     #0x000C, w2
        and     w1, w2, w1
        sl      w1, #12, w1
        mov     U1RXREG, w2
        ior     w1, w2, w1
        mov     w1, [w4++]
        inc     0x0A00
        bra     look
)",
                       kBrg, mode | kEnable, pause);
}

/// Runs both up to `until` in steps, frames from `a` to `b`, b's UxRTS to a's UxCTS.
void run(End& a, End& b, Time until) {
    std::size_t given = 0;
    for (Time now = a.chip.now(); now < until;) {
        now += 2 * kMicrosecond;
        a.chip.run_until(now);
        for (; given < a.pins.frames.size(); ++given) {
            const cosim::UartFrame& frame = a.pins.frames[given];
            b.chip.run_until(std::max(b.chip.now(), protocols::stop_bit_start(frame)));
            b.chip.uart_receive(1, frame);
        }
        b.chip.run_until(now);
        const bool rts = b.pins.out(PortLetter::D, kRts).value_or(true);
        if (rts != a.cts()) a.set_cts(rts);
    }
    a.pins.frames.clear();
}

std::vector<int> received(End& b) {
    std::vector<int> words;
    for (int i = 0; i < b.word(0x0A00); ++i)
        words.push_back(b.word(0x1000 + 2 * i));
    return words;
}

std::vector<int> counted(int count) {
    std::vector<int> words;
    for (int i = 0; i < count; ++i)
        words.push_back(0x41 + i);
    return words;
}

}  // namespace

TEST_CASE("an inverted pair of UARTs works as a plain one does, character by character in time", "[uart]") {
    std::vector<Time> times[2];
    for (const bool inverted : {false, true}) {
        End a(sender(0, inverted ? kUtxinv : 0, 10)), b(receiver(inverted ? kUrxinv : 0, 1));
        int before = 0;
        for (Time now = 0; now < 3 * kMillisecond; now += 5 * kMicrosecond) {
            run(a, b, now);
            for (; before < b.word(0x0A00); ++before)
                times[inverted].push_back(now);
        }
        CHECK(a.pins.out(PortLetter::F, kTx) == !inverted);
        CHECK(received(b) == counted(10));
    }
    CHECK(times[0] == times[1]);
}

TEST_CASE("an inverted sender is a break and garbage to a plain receiver, and the other way round",
          "[uart]") {
    End a(sender(0, kUtxinv, 5)), b(receiver(0, 1));
    run(a, b, 3 * kMillisecond);
    std::vector<int> words = received(b);
    REQUIRE(!words.empty());
    CHECK(words[0] == 0x4000);  // low at rest: FERR
    CHECK(words != counted(5));
    End c(sender(0, 0, 5)), d(receiver(kUrxinv, 1));
    run(c, d, 3 * kMillisecond);
    words = received(d);
    REQUIRE(!words.empty());
    CHECK(words != counted(5));
}

TEST_CASE("switching the polarity of a running receiver is a falling edge to it", "[uart]") {
    End b(R"(
main:   mov     #0x0900, w15
        mov     #0x8000, w0
        mov     w0, U1MODE
        repeat  #1000
        nop
        bset    U1MODE, #4
stay:   bra     stay
)");
    b.chip.run_until(kMillisecond);
    CHECK((b.chip.peek("U1STA") & 0x0005) == 0x0005);  // a character, and FERR
    CHECK(b.chip.peek("U1RXREG") == 0);
}

TEST_CASE("IrDA: a pair with pulses works, a receiver without the decoder hears nothing", "[uart]") {
    for (const bool low : {false, true}) {  // at rest: UTXINV has the other sense with IREN
        End a(sender(kIren, low ? 0 : kUtxinv, 10)), b(receiver(kIren | (low ? kUrxinv : 0), 1));
        run(a, b, 3 * kMillisecond);
        CHECK(received(b) == counted(10));
        CHECK(a.pins.out(PortLetter::F, kTx) == !low);
    }
    End a(sender(kIren, kUtxinv, 10)), b(receiver(0, 1));
    run(a, b, 3 * kMillisecond);
    CHECK(received(b).empty());
    // The other way round the decoder makes one bit of each low stretch.
    End c(sender(0, 0, 10)), d(receiver(kIren, 1));
    run(c, d, 3 * kMillisecond);
    CHECK_FALSE(received(d).empty());
    CHECK(received(d) != counted(10));
}

TEST_CASE("UxCTS holds the next frame, not the one under way", "[uart]") {
    End a(sender(kUenBoth, 0, 2));
    a.chip.run_until(5 * kMillisecond);
    CHECK(a.pins.frames.empty());
    CHECK_FALSE(a.chip.peek("U1STA") & 0x0100);  // TRMT
    a.set_cts(false);
    const Time low = a.chip.now();
    a.chip.run_until(low + 20 * kMicrosecond);
    a.set_cts(true);
    a.chip.run_until(low + kMillisecond);
    REQUIRE(a.pins.frames.size() == 1);
    CHECK(a.pins.frames[0].data == 0x41);
    CHECK(a.pins.frames[0].start >= low);
    CHECK(a.pins.frames[0].start < low + kMicrosecond);
    a.set_cts(false);
    a.chip.run_until(low + 2 * kMillisecond);
    CHECK(a.sent_words() == 2);
    CHECK(a.chip.peek("U1STA") & 0x0100);
    // Without UEN the pin is a port's.
    End free(sender(kUenRts, 0, 2));
    free.chip.run_until(5 * kMillisecond);
    CHECK(free.sent_words() == 2);
}

TEST_CASE("UxRTS keeps a fast sender from overrunning a slow reader", "[uart]") {
    const int count = 40;
    const Time enough = 60 * kMillisecond;
    End a(sender(kUenBoth, 0, count)), b(receiver(kUenRts, 900));
    run(a, b, enough);
    CHECK(b.word(0x0A02) == 0);
    CHECK(received(b) == counted(count));
    End c(sender(0, 0, count)), d(receiver(0, 900));
    run(c, d, enough);
    CHECK(d.word(0x0A02) != 0);
    CHECK_FALSE(d.pins.out(PortLetter::D, kRts));
}

TEST_CASE("UxRTS is high from the fourth character on until one is read, and with OERR", "[uart]") {
    End b(R"(
main:   mov     #0x0900, w15
        mov     #1, w0
        mov     w0, U1BRG
        mov     #0x8100, w0
        mov     w0, U1MODE
wait:   mov     PORTG, w1           ; RG0 asks for a reading
        btss    w1, #0
        bra     wait
        mov     U1RXREG, w2
stay:   bra     stay
)");
    b.pins.outside[PortLetter::G] = 0;
    Time at = kMillisecond;
    const auto give = [&](std::uint16_t data) {
        cosim::UartFrame frame;
        frame.start = at;
        frame.bit_period = kFrame / 10;
        frame.data = data;
        b.chip.run_until(protocols::stop_bit_start(frame));
        b.chip.uart_receive(1, frame);
        at += 2 * kFrame;
        b.chip.run_until(at);
    };
    b.chip.run_until(at);
    for (int i = 0; i < 3; ++i) {
        CHECK(b.pins.out(PortLetter::D, kRts) == false);
        give(0x55);
    }
    CHECK(b.pins.out(PortLetter::D, kRts) == false);
    give(0x56);
    CHECK(b.pins.out(PortLetter::D, kRts) == true);
    b.pins.outside[PortLetter::G] = 1;
    b.chip.pins_changed(PortLetter::G);
    b.chip.run_until(at += kMillisecond);
    CHECK(b.pins.out(PortLetter::D, kRts) == false);
    give(0x57);
    CHECK(b.pins.out(PortLetter::D, kRts) == true);
    give(0x58);
    CHECK(b.chip.peek("U1STA") & 0x0002);
    CHECK(b.pins.out(PortLetter::D, kRts) == true);
}

TEST_CASE("in simplex mode UxRTS is low while something is to be sent", "[uart]") {
    End a(sender(kUenBoth | kRtsmd, 0, 3));
    a.chip.run_until(400 * kMicrosecond);
    CHECK(a.pins.out(PortLetter::D, kRts) == true);
    a.chip.run_until(5 * kMillisecond);
    CHECK(a.pins.out(PortLetter::D, kRts) == false);  // CTS is high: it asks
    a.set_cts(false);
    a.chip.run_until(a.chip.now() + 3 * kFrame + 20 * kMicrosecond);
    CHECK(a.sent_words() == 3);
    CHECK(a.pins.out(PortLetter::D, kRts) == true);
}

TEST_CASE("looped back, a UART hears itself in either polarity and coding, and is its own UxCTS", "[uart]") {
    for (const unsigned mode : {0u, kUrxinv, kIren | kUrxinv}) {
        const unsigned sta = kUtxen | (mode == kUrxinv ? kUtxinv : 0);
        CAPTURE(mode);
        End a(fmt::format(R"(
main:   mov     #0x0900, w15
        mov     #3, w0
        mov     w0, U1BRG
        mov     #{:#x}, w0
        mov     w0, U1MODE
        mov     #{:#x}, w0
        mov     w0, U1STA
        repeat  #2000
        nop
        mov     #0x5A, w1
        mov     w1, U1TXREG
        mov     #0xC3, w1
        mov     w1, U1TXREG
stay:   bra     stay
)",
                          mode | kEnable | kLpback | kUenBoth, sta));
        a.chip.run_until(5 * kMillisecond);
        CHECK((a.chip.peek("U1STA") & 0x000F) == 0x0001);
        CHECK(a.chip.peek("U1RXREG") == 0x5A);
        CHECK(a.pins.frames.empty());
    }
}

TEST_CASE("the 30F's UARTs have none of it: the bits read 0, its line is a plain one", "[uart]") {
    End a(R"(
main:   mov     #0x0900, w15
        mov     #0xDB18, w0         ; IREN, RTSMD, UEN, URXINV, BRGH and what no part has
        mov     w0, U1MODE
        mov     U1MODE, w1
        mov     w1, 0x0A00
        mov     #0x7400, w0
        mov     w0, U1STA
        mov     U1STA, w2
        mov     w2, 0x0A02
        mov     #0x55, w0
        mov     w0, U1TXREG
stay:   bra     stay
)",
          dspic30f6014a());
    a.chip.run_until(20 * kMillisecond);
    CHECK(a.word(0x0A00) == 0x8000);
    CHECK(a.word(0x0A02) == 0x0510);
    REQUIRE(a.pins.frames.size() == 1);
    CHECK(is_sound(a.pins.frames[0]));
}

TEST_CASE("a UART's line is saved with it", "[uart]") {
    const std::string sends = sender(kUenBoth, kUtxinv, 12), takes = receiver(kUenRts | kUrxinv, 300);
    End a(sends), b(takes);
    a.set_cts(false);
    for (Time now = 0; now < 4 * kMillisecond; now += 37 * kMicrosecond) {
        run(a, b, now);
        std::vector<std::uint8_t> bytes[2];
        StateWriter writer[2] = {StateWriter(bytes[0]), StateWriter(bytes[1])};
        std::as_const(a.chip).state(writer[0]);
        std::as_const(b.chip).state(writer[1]);
        End again(sends), other(takes);
        again.pins.outside = a.pins.outside;
        other.pins.own = b.pins.own;
        other.pins.drives = b.pins.drives;
        StateReader reader[2] = {StateReader(bytes[0]), StateReader(bytes[1])};
        again.chip.state(reader[0]);
        other.chip.state(reader[1]);
        run(again, other, 8 * kMillisecond);
        CHECK(received(other) == counted(12));
    }
}
