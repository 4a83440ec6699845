// The converter repeats a group of conversions whose inputs stand still without asking for them again, and
// states until when its buffers stay as they are. Neither may be seen: two converters, one with pins that say
// when they stand still, agree at every access.

#include "base/random.h"
#include "emu/dspic/peripherals/adc12.h"
#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop::dspic;
using namespace puckloop::dspic::test;
using puckloop::RandomStream;

namespace {

struct SteadyPins : FakePins {
    bool tells = false;
    std::uint64_t epoch = 1;
    std::uint64_t analog_epoch(Cycle) override { return tells ? epoch : 0; }
};

struct AdcBench : Bench {
    SteadyPins inputs;
    Adc12 adc{around, clock, inputs};

    explicit AdcBench(bool tells) { inputs.tells = tells; }
    void set(int channel, double fraction) {
        if (now > 0) adc.catch_up(now - 1);
        inputs.volts[static_cast<std::size_t>(channel)] = fraction;
        ++inputs.epoch;
    }
    /// What is stored counts as long as the converter states it.
    void check_plain(std::uint16_t address) {
        const SfrSpace::Plain& plain = sfr.plain();
        const bool only_look = now < plain.until[plain.kind[address / 2]];
        const std::uint16_t stored = sfr.raw(address);
        const std::uint16_t value = read(address);
        if (only_look) CHECK(stored == value);
    }
};

std::uint16_t pick(RandomStream& random, std::initializer_list<std::uint16_t> choice) {
    return choice.begin()[random.below(choice.size())];
}

}  // namespace

TEST_CASE("groups of conversions repeated or converted, whatever is written and changes in between") {
    std::size_t asked = 0, asked_again = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        RandomStream random(seed, "groups");
        AdcBench lazy(true), eager(false);
        const auto both = [&](auto action) {
            action(lazy);
            action(eager);
        };
        const auto write = [&](std::uint16_t address, std::uint16_t value) {
            both([&](AdcBench& bench) { bench.write(address, value); });
        };
        const auto configure = [&] {
            write(sfr::ADCON2,
                  static_cast<std::uint16_t>(random.below(16) << 2 | (random.below(4) ? 0x0400 : 0) |
                                             (random.below(6) ? 0 : 2)));
            write(sfr::ADCON3, static_cast<std::uint16_t>(random.below(4) << 8 | random.below(40) |
                                                          (random.below(8) ? 0 : 0x80)));
            write(sfr::ADCHS, static_cast<std::uint16_t>(random.below(16)));
            write(sfr::ADCSSL, pick(random, {0xFF00, 0x001C, 0x0101, 0xFFFF, 0}));
            write(sfr::ADPCFG, pick(random, {0, 0x0003, 0x0100}));
            write(sfr::ADCON1, pick(random, {0x80E4, 0x80E4, 0x82E4, 0x8044, 0}));
        };
        configure();
        Cycle now = 0;
        for (int step = 0; step < 200; ++step) {
            now += 1 + random.below(random.below(3) ? 9000 : 40);
            both([&](AdcBench& bench) { bench.go(now); });
            INFO("seed " << seed << ", step " << step << ", cycle " << now);
            REQUIRE(lazy.take(irq::ADC) == eager.take(irq::ADC));
            switch (random.below(12)) {
            case 0: {
                const auto channel = static_cast<int>(random.below(16));
                const double fraction = random.uniform();
                both([&](AdcBench& bench) { bench.set(channel, fraction); });
                break;
            }
            case 1:
                if (random.below(6) == 0) configure();
                break;
            case 2: {
                const bool on = random.below(2) != 0;
                both([&](AdcBench& bench) { bench.adc.hold(on); });
                break;
            }
            case 3:
                write(sfr::ADCON1, pick(random, {0x80E4, 0x80E4, 0x00E4}));
                break;
            default:
                for (int i = 0; i < 3; ++i)
                    lazy.check_plain(static_cast<std::uint16_t>(sfr::ADCBUF0 + 2 * random.below(16)));
                for (std::uint16_t address = sfr::ADCBUF0; address <= sfr::ADCHS;
                     address = static_cast<std::uint16_t>(address + 2))
                    REQUIRE(lazy.read(address) == eager.read(address));
            }
        }
        asked += eager.inputs.samples.size();
        asked_again += lazy.inputs.samples.size();
    }
    CHECK(4 * asked_again < 3 * asked);
}
