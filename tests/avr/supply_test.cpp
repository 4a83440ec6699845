// The supply of an ATmega1284P falls and comes back: when it is reset, how long it stays there by its fuses,
// and what its program finds. Source: data sheet 8272, "System Clock" (tables of start-up times), "System
// Control and Reset", "System and Reset Characteristics".

#include "base/random.h"
#include "base/states/archive.h"
#include "tests/avr/rig.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::avr;
using cosim::kMicrosecond;
using cosim::kMillisecond;
using cosim::Time;

namespace {

/// Each start: MCUSR to 0x0100, a count at 0x0101, PB0 on; then MCUSR is 0.
constexpr const char* kStarts = R"(
        in   r16, MCUSR
        sts  0x100, r16
        lds  r17, 0x101
        inc  r17
        sts  0x101, r17
        clr  r16
        out  MCUSR, r16
        sbi  DDRB, 0
        sbi  PORTB, 0
loop:   rjmp loop
)";
constexpr std::uint8_t kPorf = 1, kExtrf = 2, kBorf = 4, kWdrf = 8;
constexpr std::uint8_t kLevel4V3 = 0xFC, kLevel2V7 = 0xFD, kLevel1V8 = 0xFE, kNoLevel = 0xFF;

ChipOptions with(std::uint8_t low, std::uint8_t extended, double hertz = 8e6, std::uint8_t high = 0xD9) {
    ChipOptions options;
    options.oscillator_hertz = hertz;
    options.fuses.low = low;
    options.fuses.high = high;
    options.fuses.extended = extended;
    options.avcc = 5.0;
    return options;
}

struct Supplied : test::Rig {
    explicit Supplied(const ChipOptions& options) : Rig(kStarts, options) {}
    void pass(Time time) { chip.run_until(chip.now() + time); }
    int starts() const { return ram(0x101); }
    int flags() const { return ram(0x100); }
    /// Since now, to the nearest 5 us; a start must come within 2.5 s.
    Time until_start() {
        const int before = starts();
        const Time from = chip.now();
        while (starts() == before) {
            REQUIRE(chip.now() < from + 2500 * kMillisecond);
            pass(5 * kMicrosecond);
        }
        return chip.now() - from;
    }
};

}  // namespace

TEST_CASE("a supply that comes back waits for the start-up time of CKSEL and SUT", "[supply]") {
    struct Row {
        std::uint8_t low;  ///< CKDIV8 off
        double hertz;
        int clocks;
        double seconds;
    };
    // CKSEL3:0 and SUT1:0 as the tables have them.
    const Row rows[] = {
        {0xC7, 16e6, 1024, 65e-3},  {0xD7, 16e6, 16384, 0},     {0xE7, 16e6, 16384, 4.1e-3},
        {0xF7, 16e6, 16384, 65e-3}, {0xC6, 16e6, 258, 4.1e-3},  {0xD6, 16e6, 258, 65e-3},
        {0xE6, 16e6, 1024, 0},      {0xF6, 16e6, 1024, 4.1e-3}, {0xCF, 8e6, 1024, 65e-3},
        {0xFE, 8e6, 1024, 4.1e-3},  {0xC2, 8e6, 6, 0},          {0xD2, 8e6, 6, 4.1e-3},
        {0xE2, 8e6, 6, 65e-3},      {0xC3, 128e3, 6, 0},        {0xE3, 128e3, 6, 65e-3},
        {0xD0, 4e6, 6, 4.1e-3},     {0xC4, 32768, 1024, 0},     {0xD5, 32768, 32768, 4.1e-3},
    };
    for (const Row& row : rows)
        for (const bool divided : {false, true}) {
            const auto low = static_cast<std::uint8_t>(divided ? row.low & 0x7F : row.low);
            Supplied s(with(low, kLevel2V7, row.hertz));
            CAPTURE(int{low});
            s.pass(3 * kMillisecond);
            REQUIRE(s.starts() == 1);  // with enough supply from the start: at once
            s.chip.set_supply(2.0);
            s.pass(10 * kMillisecond);
            s.chip.set_supply(3.3);
            const double right = row.seconds + (14 + row.clocks) / row.hertz;
            const double program = (divided ? 8 : 1) * 10 / row.hertz;
            const double took = cosim::to_seconds(s.until_start());
            CHECK(took > right);
            CHECK(took < right + program + 15e-6);
            CHECK(s.flags() == kBorf);
        }
}

TEST_CASE("the brown-out detector has half of its 50 mV of hysteresis on either side of BODLEVEL",
          "[supply]") {
    const std::pair<std::uint8_t, double> levels[] = {{kLevel4V3, 4.3}, {kLevel2V7, 2.7}, {kLevel1V8, 1.8}};
    for (const auto& [fuse, volts] : levels) {
        Supplied s(with(0xE2, fuse));
        CAPTURE(volts);
        s.pass(kMillisecond);
        s.chip.set_supply(volts - 0.024);
        s.pass(100 * kMillisecond);
        CHECK(s.starts() == 1);
        s.chip.set_supply(volts - 0.026);
        s.pass(kMillisecond);
        CHECK((s.edges.back().driven & 1) == 0);  // all pins are inputs
        s.chip.set_supply(volts + 0.024);
        s.pass(100 * kMillisecond);
        CHECK(s.starts() == 1);
        s.chip.set_supply(volts + 0.026);
        CHECK(cosim::to_seconds(s.until_start()) == Approx(65e-3).margin(0.1e-3));
        const ChipReport report = s.chip.report();
        REQUIRE(report.resets.size() == 2);
        CHECK(report.resets[1].cause == ResetCause::BrownOut);
    }
}

TEST_CASE("a dip of less than tBOD, 2 us, is no brown-out", "[supply]") {
    RandomStream random(Catch::rngSeed(), "dips");
    for (int i = 0; i < 40; ++i) {
        Supplied s(with(0xE2, kLevel2V7));
        s.pass(kMillisecond + static_cast<Time>(random.below(100'000'000)));
        const Time width = static_cast<Time>(random.below(4'000'000));  // ps
        CAPTURE(width);
        s.chip.set_supply(2.2);
        s.pass(width);
        s.chip.set_supply(3.3);
        s.pass(100 * kMillisecond);
        if (width < 1'750'000) CHECK(s.starts() == 1);
        if (width > 2'250'000) CHECK(s.starts() == 2);
    }
}

TEST_CASE("another reset within tBOD leaves the brown-out that follows its flag", "[supply]") {
    RandomStream random(Catch::rngSeed(), "resets within tBOD");
    for (int i = 0; i < 20; ++i) {
        Supplied s(with(0xE2, kLevel2V7));
        s.pass(kMillisecond);
        s.chip.set_supply(2.2);
        s.pass(static_cast<Time>(random.below(1'700'000)));  // ps
        s.chip.external_reset();
        s.pass(100 * kMillisecond);
        s.chip.set_supply(3.3);
        s.until_start();
        CHECK((s.flags() & kBorf) != 0);
        CHECK(s.chip.report().resets.back().cause == ResetCause::BrownOut);
    }
}

TEST_CASE("without BODLEVEL the supply resets below 1.3 V only, a failure within a brown-out is PORF's",
          "[supply]") {
    Supplied off(with(0xE2, kNoLevel));
    off.pass(kMillisecond);
    off.chip.set_supply(1.4);
    off.pass(100 * kMillisecond);
    CHECK(off.starts() == 1);
    off.chip.set_supply(1.2);
    off.pass(kMillisecond);
    off.chip.set_supply(5.0);
    off.until_start();
    CHECK(off.flags() == kPorf);

    Supplied s(with(0xE2, kLevel2V7));
    s.pass(kMillisecond);
    for (const double volts : {2.6, 0.0, 2.6}) {
        s.chip.set_supply(volts);
        s.pass(kMillisecond);
    }
    s.chip.set_supply(5.0);
    s.until_start();
    CHECK(s.flags() == kPorf);
    // The button's flag stays beside the others.
    s.chip.external_reset();
    s.pass(kMillisecond);
    CHECK(s.flags() == kExtrf);
}

TEST_CASE("a dip within the start-up time starts it anew, neither button nor watchdog end it", "[supply]") {
    Supplied s(with(0xE2, kLevel2V7, 8e6, 0xC9));  // WDTON: 16 ms that nobody clears
    s.pass(kMillisecond);
    s.chip.set_supply(2.0);
    s.pass(40 * kMillisecond);
    s.chip.set_supply(5.0);
    s.pass(60 * kMillisecond);
    s.chip.external_reset();
    s.chip.set_supply(2.6);
    s.pass(kMillisecond);
    s.chip.set_supply(5.0);
    CHECK(s.starts() == 1);
    CHECK(cosim::to_seconds(s.until_start()) == Approx(65e-3).margin(0.1e-3));
    CHECK(s.starts() == 2);
    CHECK((s.flags() & kWdrf) == 0);
    CHECK((s.flags() & kBorf) != 0);
    s.until_start();  // now the watchdog runs
    CHECK(s.flags() == kWdrf);
}

TEST_CASE("a chip that was saved while its supply held it goes on as one that was not", "[supply]") {
    for (const bool returning : {false, true}) {
        const ChipOptions options = with(0xF7, kLevel2V7, 16e6);
        Supplied a(options), b(options);
        a.pass(kMillisecond);
        a.chip.set_supply(2.5);
        a.pass(3 * kMillisecond);
        if (returning) a.chip.set_supply(3.3);
        a.pass(kMillisecond);
        std::vector<std::uint8_t> bytes;
        StateWriter writer(bytes);
        std::as_const(a.chip).state(writer);
        StateReader reader(bytes);
        b.chip.state(reader);
        for (Supplied* s : {&a, &b}) {
            s->chip.set_supply(3.3);
            s->until_start();
        }
        CHECK(a.chip.cycle() == b.chip.cycle());
        CHECK(a.flags() == b.flags());
        CHECK(b.starts() == 2);
    }
}
