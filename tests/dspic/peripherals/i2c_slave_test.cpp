// The I2C slave against a scripted bus: acknowledge, status bits, stretching, the wait on TBF, a lost byte,
// mask, general call. The program is a register file with the structure of the range-and-bearing board's.

#include "tests/dspic/chip33_bench.h"

#include <catch2/catch.hpp>

#include <optional>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

constexpr Time kPeriod = cosim::kSecond / 100'000;
constexpr int kLog = 0x1000;  // what the service routine saw: status, byte, status, byte, ...

/// `work`: cycles spent on a data byte before SCL is let go. `stren`: 0x40 or 0.
std::string program(int work, int stren) {
    return R"(
        .org 0x0034
        .pword isr
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        mov #0x1000, w10
        mov #0x5A, w11
        mov #0x20, w0
        mov w0, I2C1ADD
        mov #)" +
           std::to_string(0x9000 + stren) + R"(, w0
        mov w0, I2C1CON
        bset IEC1, #0
wait:   bra wait
isr:    bclr IFS1, #0
        mov I2C1STAT, w0
        mov w0, [w10++]
        btst.z w0, #2        ; R_W
        bra nz, send
        mov I2C1RCV, w1
        mov w1, [w10++]
        btst.z w0, #5        ; D_A
        bra z, free
        repeat #)" +
           std::to_string(work) + R"(
        nop
free:   bset I2C1CON, #12
        retfie
send:   mov I2C1RCV, w1
        mov w1, [w10++]
        mov w11, I2C1TRN
        inc w11, w11
        bset I2C1CON, #12
full:   btst I2C1STAT, #0    ; TBF
        bra nz, full
sent:   retfie
)";
}

/// A bus master at 100 kHz that waits for each answer.
struct Bus : Bench33 {
    Time bus = 100 * cosim::kMicrosecond;
    I2cPhase asked;

    explicit Bus(const std::string& source) : Bench33(source) {}
    I2cPhase phase(I2cPhaseKind kind, int byte = 0) {
        chip.run_until(bus);
        asked = {};
        asked.kind = kind;
        asked.byte = static_cast<std::uint8_t>(byte);
        asked.ack = 1;
        asked.start = bus;
        asked.clock_period = kPeriod;
        pins.answers.clear();
        chip.i2c_slave_phase(1, asked);
        if (kind == I2cPhaseKind::Stop) {
            bus += kPeriod;
            return {};
        }
        for (int i = 0; pins.answers.empty(); ++i) {
            REQUIRE(i < 10'000);
            // Never earlier than promised.
            const Time bound = chip.earliest_i2c_slave_answer(1);
            CHECK(bound != cosim::kNever);
            chip.run_until(chip.now() + cosim::kMicrosecond);
            if (!pins.answers.empty()) {
                const I2cPhase& answer = pins.answers[0];
                CHECK(answer.start + 8 * kPeriod + answer.stretch >= bound);
            }
        }
        CHECK(chip.earliest_i2c_slave_answer(1) == cosim::kNever);
        const I2cPhase answer = pins.answers[0];
        CHECK(answer.start == asked.start);
        bus = answer.start + 9 * kPeriod + answer.stretch;
        return answer;
    }
    int status() { return chip.peek("I2C1STAT"); }
};

constexpr int kDataReceived = 0x0020;  // D_A
constexpr int kStopSeen = 0x0010, kStartSeen = 0x0008, kReads = 0x0004, kFull = 0x0002, kToSend = 0x0001;

}  // namespace

TEST_CASE("a write is acknowledged byte by byte and stretched while the program works") {
    Bus bus(program(400, 0x40));
    const I2cPhase address = bus.phase(I2cPhaseKind::Start, 0x40);
    CHECK(address.kind == I2cPhaseKind::Acknowledge);
    CHECK(address.ack == 1);
    CHECK(address.stretch == 0);  // SCL is not held after an address to write
    const I2cPhase first = bus.phase(I2cPhaseKind::Write, 0x0E);
    CHECK(first.ack == 1);
    CHECK(in_microseconds(first.stretch) == Approx(415 / 3.685).epsilon(0.02));
    const I2cPhase second = bus.phase(I2cPhaseKind::Write, 0x77);
    CHECK(second.ack == 1);
    CHECK(second.stretch >= cosim::kMicrosecond * 100);
    CHECK((bus.status() & (kStartSeen | kStopSeen)) == kStartSeen);
    bus.phase(I2cPhaseKind::Stop);
    bus.chip.run_until(bus.bus);
    CHECK((bus.status() & (kStartSeen | kStopSeen)) == kStopSeen);
    // Status, byte: the address, then two data bytes, each read in time.
    CHECK(bus.word(kLog) == (kStartSeen | kFull));
    CHECK(bus.word(kLog + 2) == 0x40);
    CHECK(bus.word(kLog + 4) == (kStartSeen | kFull | kDataReceived));
    CHECK(bus.word(kLog + 6) == 0x0E);
    CHECK(bus.word(kLog + 10) == 0x77);
    CHECK(bus.word(kLog + 12) == 0);
    CHECK((bus.status() & 0x0040) == 0);
}

TEST_CASE("a read waits for SCLREL, the program waits for TBF, and the last byte does not interrupt") {
    Bus bus(program(0, 0x40));
    CHECK(bus.phase(I2cPhaseKind::Start, 0x41).ack == 1);
    const I2cPhase data = bus.phase(I2cPhaseKind::Read);
    CHECK(data.kind == I2cPhaseKind::Data);
    CHECK(data.byte == 0x5A);
    CHECK(data.stretch > 0);
    CHECK(data.stretch < 10 * cosim::kMicrosecond);
    CHECK(bus.word(kLog) == (kStartSeen | kReads | kFull));
    CHECK(bus.word(kLog + 2) == 0x41);
    CHECK(bus.word(kLog + 4) == 0);
    CHECK((bus.status() & kToSend) == 0);
    // Acknowledged: another interrupt, another byte.
    CHECK(bus.phase(I2cPhaseKind::Read).byte == 0x5B);
    CHECK(bus.word(kLog + 4) == (kStartSeen | kReads | kDataReceived));
    bus.phase(I2cPhaseKind::Stop);
    bus.chip.run_until(bus.bus + cosim::kMillisecond);
    CHECK(bus.word(kLog + 8) == 0);  // not acknowledged: no interrupt
    CHECK((bus.chip.peek("I2C1CON") & 0x1000) == 0x1000);
}

TEST_CASE("the service routine of a read spins for eight clocks from the release of SCL") {
    Bus bus(program(0, 0x40));
    bus.phase(I2cPhaseKind::Start, 0x41);
    I2cPhase read;
    read.kind = I2cPhaseKind::Read;
    read.start = bus.bus;
    read.clock_period = kPeriod;
    bus.chip.run_until(bus.bus);
    bus.chip.i2c_slave_phase(1, read);
    const Time full = bus.run_to_label("full");
    const Time sent = bus.run_to_label("sent");
    CHECK(in_microseconds(sent - full) == Approx(80).margin(2));
    CHECK(bus.pins.answers.size() == 2);
}

TEST_CASE("a byte that is left over from a transfer that was given up is sent without holding SCL") {
    Bus bus(R"(
        .org 0x200
main:   mov #0x7FF0, w0
        mov w0, SPLIM
        mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9240, w0
        mov w0, I2C1CON
wait:   btss IFS1, #0
        bra wait
        bclr IFS1, #0
        mov I2C1STAT, w2
        mov I2C1RCV, w1
        mov #0x5A, w0
        btst.z w2, #2       ; R_W
        bra z, free
        mov w0, I2C1TRN
free:   bset I2C1CON, #12
        bra wait
)");
    bus.phase(I2cPhaseKind::Start, 0x41);
    bus.chip.run_until(bus.bus + cosim::kMillisecond);
    bus.bus = bus.chip.now() + cosim::kMicrosecond;
    CHECK((bus.status() & kToSend) == kToSend);
    bus.phase(I2cPhaseKind::Start, 0x40);  // a repeated START before a bit of it was clocked
    bus.phase(I2cPhaseKind::Stop);
    bus.chip.run_until(bus.bus + cosim::kMillisecond);
    bus.bus = bus.chip.now() + cosim::kMicrosecond;
    CHECK((bus.status() & kToSend) == kToSend);
    CHECK(bus.phase(I2cPhaseKind::Start, 0x41).ack == 1);
    const I2cPhase data = bus.phase(I2cPhaseKind::Read);  // begun before the address is shown
    CHECK(data.kind == I2cPhaseKind::Data);
    CHECK(data.byte == 0x5A);
    CHECK(data.stretch == 0);
}

TEST_CASE("without STREN a byte that nobody fetched costs the next one") {
    // Without an interrupt nobody reads I2C1RCV.
    Bus bus(R"(
        .org 0x200
main:   mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9000, w0
        mov w0, I2C1CON
wait:   btss IFS1, #0
        bra wait
        mov I2C1RCV, w0      ; the address
spin:   bra spin
)");
    CHECK(bus.phase(I2cPhaseKind::Start, 0x40).ack == 1);
    const I2cPhase first = bus.phase(I2cPhaseKind::Write, 0x01);
    CHECK(first.ack == 1);
    CHECK(first.stretch == 0);
    CHECK(bus.phase(I2cPhaseKind::Write, 0x02).ack == 0);
    bus.chip.run_until(bus.bus + cosim::kMicrosecond);
    CHECK(bus.chip.peek("I2C1RCV") == 0x01);
    CHECK((bus.status() & 0x0042) == 0x0042);  // I2COV, RBF
    CHECK(bus.phase(I2cPhaseKind::Start, 0x40).ack == 0);
}

TEST_CASE("other addresses are not answered, masked ones and the general call are if asked for") {
    const auto configured = [](int mask, int control) {
        return "        .org 0x200\nmain: mov #0x20, w0\n mov w0, I2C1ADD\n mov #" + std::to_string(mask) +
               ", w0\n mov w0, I2C1MSK\n mov #" + std::to_string(control) +
               ", w0\n mov w0, I2C1CON\nwait: mov I2C1RCV, w0\n bra wait\n";
    };
    Bus plain(configured(0, 0x9000));
    CHECK(plain.phase(I2cPhaseKind::Start, 0x42).ack == 0);
    CHECK(plain.phase(I2cPhaseKind::Write, 0x00).ack == 0);
    CHECK(plain.phase(I2cPhaseKind::Start, 0x00).ack == 0);
    Bus masked(configured(0x03, 0x9000));
    CHECK(masked.phase(I2cPhaseKind::Start, 0x46).ack == 1);
    CHECK(masked.phase(I2cPhaseKind::Start, 0x48).ack == 0);
    Bus general(configured(0, 0x9080));
    CHECK(general.phase(I2cPhaseKind::Start, 0x00).ack == 1);
    general.chip.run_until(general.bus + cosim::kMicrosecond);
    CHECK((general.status() & 0x0200) == 0x0200);
    // Reserved addresses never match, whatever the mask; 0x78 begins a ten-bit address.
    Bus any(configured(0x7F, 0x9000));
    int answered = 0;
    for (int address = 0; address < 0x80; ++address) {
        INFO("address " << address);
        const bool reserved = address < 0x08 || address > 0x77;
        for (const int reads : {0, 1}) {
            const bool acknowledged = any.phase(I2cPhaseKind::Start, address << 1 | reads).ack != 0;
            CHECK(acknowledged == !reserved);
            answered += acknowledged;
            if (acknowledged && reads == 1) any.phase(I2cPhaseKind::Stop);
        }
    }
    CHECK(answered == 2 * 0x70);
    Bus off(configured(0, 0x1000));
    CHECK(off.phase(I2cPhaseKind::Start, 0x40).ack == 0);
    CHECK((off.status() & kStartSeen) == 0);
}

TEST_CASE("a reset or switching off while SCL is held lets the bus go with a not-acknowledge") {
    Bus bus(R"(
        .org 0x200
main:   mov #0x20, w0
        mov w0, I2C1ADD
        mov #0x9040, w0
        mov w0, I2C1CON
wait:   btss IFS1, #0
        bra wait
        mov I2C1RCV, w0
        bclr IFS1, #0
data:   btss IFS1, #0
        bra data
        repeat #1000
        nop
        clr I2C1CON
spin:   bra spin
)");
    CHECK(bus.phase(I2cPhaseKind::Start, 0x40).ack == 1);
    const I2cPhase byte = bus.phase(I2cPhaseKind::Write, 0x01);
    CHECK(byte.ack == 0);
    CHECK(in_microseconds(byte.stretch) == Approx(1000 / 3.685).epsilon(0.05));
}

TEST_CASE("10-bit addresses: the second byte is the one that counts, a read repeats the first") {
    Bus bus(program(0, 0x440));  // A10M, STREN; I2C1ADD = 0x020
    constexpr int kTen = 0x0100;
    // The right first byte is acknowledged without a sign, the wrong second one is not.
    CHECK(bus.phase(I2cPhaseKind::Start, 0xF0).ack == 1);
    CHECK(bus.phase(I2cPhaseKind::Write, 0x21).ack == 0);
    CHECK(bus.phase(I2cPhaseKind::Write, 0x20).ack == 0);
    bus.phase(I2cPhaseKind::Stop);
    CHECK(bus.phase(I2cPhaseKind::Start, 0xF2).ack == 0);  // A8 = 1
    CHECK(bus.phase(I2cPhaseKind::Start, 0x40).ack == 0);  // the same as a 7-bit address
    CHECK(bus.phase(I2cPhaseKind::Start, 0xF1).ack == 0);  // nobody was addressed before
    bus.phase(I2cPhaseKind::Stop);
    CHECK(bus.word(kLog) == 0);

    CHECK(bus.phase(I2cPhaseKind::Start, 0xF0).ack == 1);
    CHECK(bus.word(kLog) == 0);
    CHECK(bus.phase(I2cPhaseKind::Write, 0x20).ack == 1);
    CHECK(bus.phase(I2cPhaseKind::Write, 0x77).ack == 1);
    CHECK((bus.word(kLog) & (kTen | kDataReceived | kReads | kFull)) == (kTen | kFull));
    CHECK(bus.word(kLog + 2) == 0x20);
    CHECK((bus.word(kLog + 4) & (kTen | kDataReceived)) == (kTen | kDataReceived));
    CHECK(bus.word(kLog + 6) == 0x77);
    CHECK(bus.phase(I2cPhaseKind::Start, 0xF1).ack == 1);
    CHECK(bus.phase(I2cPhaseKind::Read).byte == 0x5A);
    CHECK((bus.word(kLog + 8) & (kTen | kReads)) == (kTen | kReads));
    bus.phase(I2cPhaseKind::Stop);
    bus.chip.run_until(bus.bus);
    CHECK((bus.status() & kTen) == 0);
    CHECK(bus.phase(I2cPhaseKind::Start, 0xF1).ack == 0);  // the stop ended it
}
