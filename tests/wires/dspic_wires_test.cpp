// The I2C slaves of both dsPICs under masters that keep to nothing: what they agree with the address byte
// they do not do, they break off in mid-byte, go on after a NACK, read what is to be written. Each drawn
// action is compared with the wires (wire_dspic.h): the line, the acknowledge, every status bit, the byte
// received, the interrupts. A program serves each interrupt as it draws: reads I2CRCV or not, loads I2CTRN or
// not, clears I2COV or not, has the next byte put into I2CTRN as soon as the one before is out or not.
//
// Of a byte that the master acknowledges the chip is informed by what follows (deviation 2 of i2c_slave.h):
// another byte, or the question for its next bit, which a STOP or START meets. It is compared then.

#include "tests/dspic/chip30_bench.h"
#include "tests/dspic/chip33_bench.h"
#include "tests/wires/wire_dspic.h"

#include <catch2/catch.hpp>
#include <fmt/format.h>

#include <cmath>

using namespace puckloop;
using namespace puckloop::wires;
using cosim::I2cPhase;
using cosim::I2cPhaseKind;
using cosim::Time;

namespace {

constexpr Time kPeriod = 100 * cosim::kMicrosecond;  // the service routine is over within a clock
constexpr int kCount = 0x1100;

/// `i2c`: "I2C" or "I2C1"; interrupt flag and enable, its vector.
std::string program(const std::string& i2c, const std::string& flag, const std::string& enable,
                    const std::string& vector, const WireDspic::Setup& setup) {
    const int control = 0x9000 | (setup.ten_bits ? 0x400 : 0) | (setup.general_call ? 0x80 : 0) |
                        (setup.stretches ? 0x40 : 0);
    std::string text = R"(
        .org {vector}
        .pword isr
        .org 0x200
main:   mov #0x1000, w15
        mov #0x1080, w0
        mov w0, SPLIM
        mov #1, w11
        mov #{factor}, w8
        mov #{sum}, w9
        mov #255, w7
        clr 0x1100
        mov #{address}, w0
        mov w0, {i2c}ADD
{mask}
        mov #{control}, w0
        mov w0, {i2c}CON
        bset {enable}
        clr w12
wait:   cp0 w12
        bra z, wait
        mov {i2c}STAT, w5
        btst w5, #0
        bra nz, wait
        mov w13, {i2c}TRN
        clr w12
        bra wait
isr:    bclr {flag}
        inc 0x1100
        mul.uu w11, w8, w2
        add w2, w9, w11
        mov {i2c}STAT, w0
        btst w0, #2
        bra z, noload
        btst w0, #6
        bra nz, noload
        btst w11, #13
        bra nz, load
        btst w11, #10
        bra z, noload
load:   lsr w11, #2, w1
        and w1, w7, w1
        mov w1, {i2c}TRN
        btst w0, #0
        bra nz, noload
        btst w11, #9
        bra z, noload
        lsr w11, #5, w13
        and w13, w7, w13
        mov #1, w12
noload: btst w11, #14
        bra nz, take
        btst w11, #12
        bra z, notake
take:   mov {i2c}RCV, w1
notake: btst w11, #15
        bra nz, clear
        btst w11, #11
        bra z, free
clear:  bclr {i2c}STAT, #6
free:   bset {i2c}CON, #12
        retfie
)";
    const auto fill = [&text](const std::string& name, const std::string& value) {
        for (std::size_t at = 0; (at = text.find(name, at)) != std::string::npos;)
            text.replace(at, name.size(), value);
    };
    fill("{vector}", vector);
    fill("{factor}", std::to_string(Policy::kFactor));
    fill("{sum}", std::to_string(Policy::kSum));
    fill("{address}", std::to_string(setup.address));
    fill("{mask}",
         setup.mask == 0 ? "" : fmt::format("        mov #{}, w0\n        mov w0, I2C1MSK", setup.mask));
    fill("{control}", std::to_string(control));
    fill("{enable}", enable);
    fill("{flag}", flag);
    fill("{i2c}", i2c);
    return text;
}

/// The chip with a master that sends phases, spaced so that the program has served what there was.
template <class Bench>
class Rig {
  public:
    Rig(const std::string& source, std::string prefix) : bench_(source), prefix_(std::move(prefix)) {
        bench_.chip.run_until(20 * cosim::kMillisecond);
    }
    int reg(const std::string& name) { return bench_.chip.peek(prefix_ + name); }
    int interrupts() { return bench_.word(kCount); }

    /// Whether SDA is low in the next clock.
    bool first_bit_low() {
        bench_.pins.answers.clear();
        bench_.chip.i2c_slave_phase(1, first_bit_from(bench_.chip.now(), kPeriod));
        for (int i = 0; i < 40 && bench_.pins.answers.empty(); ++i)
            bench_.chip.run_until(bench_.chip.now() + kPeriod / 2);
        REQUIRE(bench_.pins.answers.size() == 1);
        const I2cPhase answer = bench_.pins.answers[0];
        CHECK(answer.kind == I2cPhaseKind::Acknowledge);
        bench_.chip.run_until(bench_.chip.now() + kPeriod);
        return answer.ack != 0;
    }

    /// Returns the answer; none for a Stop and for a byte that is broken off.
    std::optional<I2cPhase> act(const Action& action) {
        const I2cPhase phase = phase_of(action, bench_.chip.now(), kPeriod);
        bench_.pins.answers.clear();
        bench_.chip.i2c_slave_phase(1, phase);
        if (action.kind == Action::Kind::Stop) {
            bench_.chip.run_until(phase.start + 2 * kPeriod);
            return {};
        }
        if (action.clocks < 9) {
            bench_.chip.run_until(phase.start + action.clocks * kPeriod + kPeriod / 2);
            CHECK(bench_.pins.answers.empty());
            return {};
        }
        for (int i = 0; i < 40 && bench_.pins.answers.empty(); ++i)
            bench_.chip.run_until(bench_.chip.now() + kPeriod / 2);
        REQUIRE(bench_.pins.answers.size() == 1);
        const I2cPhase answer = bench_.pins.answers[0];
        bench_.chip.run_until(answer.start + answer.stretch + 11 * kPeriod);
        return answer;
    }

  private:
    Bench bench_;
    std::string prefix_;
};

constexpr int kCompared = 0x3FF;

/// Counts of what was drawn, so that a test cannot pass by drawing nothing.
struct Seen {
    int actions = 0, both_sent = 0, ones_received = 0, broken = 0, behind_nack = 0, overruns = 0, sent = 0,
        acknowledged = 0, loaded_early = 0, first_bits = 0, first_low = 0;
};

template <class Bench>
void compare(Rig<Bench>& rig, WireDspic& wires, Draw& draw, int actions, Seen& seen) {
    bool begun = false, acknowledged = false, ended = false, sends = false;
    const auto same = [&] {
        CHECK((rig.reg("STAT") & kCompared) == wires.status());
        CHECK(rig.interrupts() == wires.interrupts());
        CHECK(rig.reg("RCV") == wires.received());
        CHECK((rig.reg("CON") & 0x1000) != 0);
    };
    for (int i = 0; i < actions; ++i) {
        Action action = draw.action(begun);
        INFO("action " << i << " kind " << static_cast<int>(action.kind) << " byte " << int(action.byte)
                       << " clocks " << action.clocks);
        ++seen.actions;
        const bool condition = action.kind == Action::Kind::Start || action.kind == Action::Kind::Stop;
        if (condition && sends) {
            const bool low = !wires.lets_go();
            CHECK(rig.first_bit_low() == low);
            ++seen.first_bits;
            seen.first_low += low;
            acknowledged = false;
            same();
            if (low) {  // neither is possible: the master clocks on
                action.kind = Action::Kind::Read;
                action.ack = draw.one_in(2);
                action.clocks = 9;
            }
        }
        sends = false;
        if (action.kind == Action::Kind::Start) wires.start();
        if (action.kind == Action::Kind::Stop) {
            wires.stop();
            rig.act(action);
            begun = acknowledged = ended = false;
            same();
            continue;
        }
        begun = true;
        const std::uint8_t drives = action.kind == Action::Kind::Read ? 0xFF : action.byte;
        if (action.clocks < 9) {
            for (int bit = 0; bit < action.clocks; ++bit)
                wires.clock(drives >> (7 - bit) & 1);
            if (wires.lets_go()) {  // else no START or STOP is possible
                rig.act(action);
                ++seen.broken;
                acknowledged = ended = false;
                Action breaks;
                if (action.broken_by_stop) {
                    wires.stop();
                    rig.act(breaks);
                    begun = false;
                    same();
                    continue;
                }
                // A START needs an address byte after it.
                breaks.kind = Action::Kind::Start;
                breaks.byte = draw.byte();
                wires.start();
                const Byte line = nine_clocks(wires, breaks.byte, false);
                const auto answer = rig.act(breaks);
                CHECK((answer->ack != 0) == line.low);
                same();
                continue;
            }
            const int before = action.clocks;
            for (int bit = before; bit < 8; ++bit)
                wires.clock(drives >> (7 - bit) & 1);
            const bool low = !wires.clock(!(action.kind == Action::Kind::Read && action.ack));
            action.clocks = 9;
            const auto answer = rig.act(action);
            if (action.kind != Action::Kind::Read) CHECK((answer->ack != 0) == low);
            acknowledged = sends = action.kind == Action::Kind::Read && action.ack && wires.sends();
            if (action.kind == Action::Kind::Start) sends = wires.sends();
            if (!acknowledged) same();
            continue;
        }
        const int overflow_before = wires.status() & 0x40;
        const Byte line = nine_clocks(wires, drives, action.kind == Action::Kind::Read && action.ack);
        const auto answer = rig.act(action);
        if (action.kind == Action::Kind::Read) {
            CHECK(answer->kind == I2cPhaseKind::Data);
            CHECK(answer->byte == line.line);
            seen.ones_received += line.low && !action.ack;
            seen.sent += line.line != 0xFF;
            seen.behind_nack += ended;
            ended = ended || !action.ack;
            seen.acknowledged += action.ack && line.line != 0xFF;
        } else {
            CHECK(answer->kind == I2cPhaseKind::Acknowledge);
            CHECK((answer->ack != 0) == line.low);
            const bool pulled = line.line != drives;
            seen.both_sent += pulled;
            if (pulled) CHECK(answer->byte == line.line);
            if (action.kind == Action::Kind::Start) ended = false;
        }
        seen.overruns += overflow_before == 0 && (wires.status() & 0x40) != 0;
        // Where the master acknowledged a byte that was sent, the interrupt comes with the next.
        acknowledged = action.kind == Action::Kind::Read && action.ack;
        sends = wires.sends();
        if (!acknowledged) same();
    }
    seen.loaded_early += wires.loaded_early();
}

WireDspic::Setup drawn(Draw& draw, bool has_mask) {
    WireDspic::Setup setup;
    setup.ten_bits = draw.one_in(3);
    setup.general_call = draw.one_in(2);
    setup.stretches = draw.one_in(2);
    setup.address = static_cast<std::uint16_t>(setup.ten_bits ? 0x2A5 : 0x15);
    if (has_mask && draw.one_in(2)) setup.mask = setup.ten_bits ? 0x102 : 0x03;
    return setup;
}

std::vector<std::uint8_t> addresses(const WireDspic::Setup& setup) {
    if (setup.ten_bits) return {0xF4, 0xF4, 0xF6, 0x00};
    return {0x2A, 0x2A, 0x2A, 0x2C, 0x00};
}

constexpr int kSeeds = 72, kActions = 400;

void check(const Seen& seen) {
    CHECK(seen.actions == seeds(kSeeds) * kActions);
    CHECK(seen.both_sent > 20);
    CHECK(seen.ones_received > 100);
    CHECK(seen.broken > 100);
    CHECK(seen.behind_nack > 50);
    CHECK(seen.overruns > 50);
    CHECK(seen.sent > 100);
    CHECK(seen.acknowledged > 50);
    CHECK(seen.loaded_early > 50);
    CHECK(seen.first_bits > 200);
    CHECK(seen.first_low > 80);
}

}  // namespace

TEST_CASE("dsPIC30F: a slave under masters that keep to nothing, against the wires") {
    Seen seen;
    const auto drawn_seeds = static_cast<std::uint64_t>(seeds(kSeeds));
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        INFO("seed " << seed);
        Draw choice(seed, {});
        WireDspic::Setup setup = drawn(choice, false);
        Rig<dspic::test::Bench30> rig(program("I2C", "IFS0, #13", "IEC0, #13", "0x002E", setup), "I2C");
        setup.transmit = static_cast<std::uint8_t>(rig.reg("TRN"));
        WireDspic wires(setup);
        Draw draw(1000 + seed, addresses(setup));
        compare(rig, wires, draw, kActions, seen);
    }
    check(seen);
}

TEST_CASE("dsPIC33F: a slave under masters that keep to nothing, against the wires") {
    Seen seen;
    const auto drawn_seeds = static_cast<std::uint64_t>(seeds(kSeeds));
    for (std::uint64_t seed = 1; seed <= drawn_seeds; ++seed) {
        INFO("seed " << seed);
        Draw choice(100 + seed, {});
        WireDspic::Setup setup = drawn(choice, true);
        Rig<dspic::test::Bench33> rig(program("I2C1", "IFS1, #0", "IEC1, #0", "0x0034", setup), "I2C1");
        setup.transmit = static_cast<std::uint8_t>(rig.reg("TRN"));
        WireDspic wires(setup);
        Draw draw(2000 + seed, addresses(setup));
        compare(rig, wires, draw, kActions, seen);
    }
    check(seen);
}
