// The supply falls and comes back: when the chip is reset, how long it stays there, and what its program
// finds.

#include "base/random.h"
#include "base/states/archive.h"
#include "tests/dspic/chip30_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using cosim::kMicrosecond;
using cosim::kMillisecond;

namespace {

constexpr std::uint32_t kFwdt = 0xF80002, kFborpor = 0xF80004;
constexpr unsigned kBoren = 0x80;
constexpr double kLevels[4] = {4.5, 4.2, 2.7, 2.0};
constexpr cosim::Time kPowerUp[4] = {0, 4 * kMillisecond, 16 * kMillisecond, 64 * kMillisecond};

/// Each start: RCON to 0x0A00, a count at 0x0A02, a rising edge at RA6; then RCON is 0.
const std::string kStarts = R"(
        .org 0x200
main:   mov RCON, w1
        mov #0x0900, w15
        mov w1, 0x0A00
        mov #0x0A02, w2
        inc [w2], [w2]
        clr RCON
        bclr TRISA, #6
        bset LATA, #6
here:   bra here
)";

struct Supply : Bench30 {
    Supply(unsigned fborpor, unsigned fwdt = 0x7FFF)
        : Bench30(kStarts, {{kFborpor, fborpor}, {kFwdt, fwdt}}) {}
    void volts(double value) {
        pins.vdd = value;
        chip.supply_changed();
    }
    void pass(cosim::Time time) { chip.run_until(chip.now() + time); }
    int starts() const { return word(0x0A02); }
    /// Since `from`, in which a start must lie within 100 ms.
    cosim::Time until_start(cosim::Time from) {
        const int before = starts();
        while (starts() == before) {
            REQUIRE(chip.now() < from + 100 * kMillisecond);
            pass(kMicrosecond);
        }
        return chip.now() - from;
    }
};

}  // namespace

TEST_CASE("the 30F is held in reset below BORV's level, and FPWRT's time longer", "[supply]") {
    RandomStream random(Catch::rngSeed(), "brown-out");
    for (unsigned borv = 0; borv < 4; ++borv) {
        const unsigned fpwrt = static_cast<unsigned>(random.next() % 4);
        CAPTURE(borv, fpwrt);
        Supply s(0x8700 | kBoren | borv << 4 | fpwrt);
        s.volts(kLevels[borv] + 0.3);
        if (kLevels[borv] > 3.3) CHECK(s.starts() == 0);  // the bench begins with 3.3 V
        s.pass(100 * kMillisecond);
        REQUIRE(s.starts() == 1);
        s.volts(kLevels[borv] + 0.001);
        s.pass(kMillisecond);
        CHECK((s.pins.driven_now[0] & 0x40) == 0x40);
        CHECK((s.reg("RCON") & 0xC0DF) == 0);
        s.volts(kLevels[borv] - 0.001);
        s.pass(10 * kMillisecond);
        CHECK((s.pins.driven_now[0] & 0x40) == 0);  // all pins are inputs
        s.volts(kLevels[borv] + 0.004);             // 5 mV of hysteresis
        s.pass(100 * kMillisecond);
        CHECK(s.starts() == 1);
        s.volts(kLevels[borv] + 0.006);
        const cosim::Time delay = s.until_start(s.chip.now());
        // The oscillator's 10 us, the crystal's 1024 periods and the PLL's 20 us come on top: 169 us.
        CHECK(delay > kPowerUp[fpwrt] + 165 * kMicrosecond);
        CHECK(delay < kPowerUp[fpwrt] + 173 * kMicrosecond);
        CHECK((s.word(0x0A00) & 0xC0DF) == 2);  // BOR alone
        const auto resets = s.chip.report().resets;
        REQUIRE(resets.size() == 2);
        CHECK(resets[1].cause == "BOR");
    }
}

TEST_CASE("without BOREN the supply resets below the power-on threshold only", "[supply]") {
    Supply s(0x8733);
    s.pass(kMillisecond);
    s.volts(1.9);
    s.pass(kMillisecond);
    CHECK(s.chip.report().resets.size() == 1);
    s.volts(1.8);
    s.pass(kMillisecond);
    s.volts(3.3);
    s.until_start(s.chip.now());
    CHECK(s.starts() == 2);
    CHECK((s.word(0x0A00) & 0xC0DF) == 3);  // POR and BOR
    CHECK(s.chip.report().resets.at(1).cause == "POR");
}

TEST_CASE("a brown-out that goes on to a power failure is a power-on reset", "[supply]") {
    Supply s(0x87A0);
    s.pass(kMillisecond);
    for (const double volts : {2.6, 0.0, 2.6}) {
        s.volts(volts);
        s.pass(kMillisecond);
    }
    s.volts(3.3);
    s.until_start(s.chip.now());
    CHECK((s.word(0x0A00) & 0xC0DF) == 3);
}

TEST_CASE("a dip within the power-up timer's time starts it anew", "[supply]") {
    Supply s(0x87A2);  // 2.7 V, 16 ms
    s.pass(kMillisecond);
    s.volts(2.5);
    s.volts(3.3);
    s.pass(15 * kMillisecond);
    s.volts(2.6);
    s.pass(kMillisecond);
    s.volts(3.3);
    CHECK(s.until_start(s.chip.now()) > 16 * kMillisecond);
    CHECK(s.starts() == 2);
}

TEST_CASE("neither watchdog nor MCLR start a chip that its supply holds in reset", "[supply]") {
    Supply s(0x87A3, 0x8000);  // 2.7 V, 64 ms; a watchdog of 2 ms that nobody clears
    s.pass(kMillisecond);
    s.volts(2.5);
    s.pass(30 * kMillisecond);
    s.volts(3.3);
    s.pass(kMillisecond);
    s.chip.mclr();
    s.pass(40 * kMillisecond);
    CHECK(s.starts() == 1);
    s.until_start(s.chip.now());
    CHECK((s.word(0x0A00) & 0x10) == 0);
    s.until_start(s.chip.now());  // now it runs
    CHECK((s.word(0x0A00) & 0x10) == 0x10);
}

TEST_CASE("a chip that was saved while its supply held it goes on as one that was not", "[supply]") {
    for (const bool returning : {false, true}) {
        Supply a(0x87A1), b(0x87A1);
        a.pass(kMillisecond);
        a.volts(2.5);
        a.pass(3 * kMillisecond);
        if (returning) a.volts(3.3);
        a.pass(kMillisecond);
        std::vector<std::uint8_t> bytes;
        StateWriter writer(bytes);
        a.chip.state(writer);
        StateReader reader(bytes);
        b.chip.state(reader);
        b.pins.vdd = a.pins.vdd;
        for (Supply* s : {&a, &b}) {
            s->volts(3.3);
            s->until_start(s->chip.now());
        }
        CHECK(a.chip.cycle() == b.chip.cycle());
        CHECK(a.word(0x0A00) == b.word(0x0A00));
        CHECK(b.starts() == 2);
    }
}
