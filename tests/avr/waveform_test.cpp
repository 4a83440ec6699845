// The timers' arithmetic against a counter that ticks.

#include "base/random.h"
#include "emu/avr/peripherals/timing/waveform.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::avr;

namespace {

/// One tick, as the data sheet draws it.
void tick(std::uint32_t& count, bool& down, const Waveform& wave, std::uint32_t top, std::uint32_t max) {
    if (!wave.dual_slope()) {
        count = count == top || count == max ? 0 : count + 1;
        return;
    }
    if (count == top) down = true;
    if (count == 0) down = false;
    count = down ? count - 1 : count + 1;
    if (count == top) down = true;
}

}  // namespace

TEST_CASE("A counter is after n ticks where ticking takes it, and leaves a value when ticking does") {
    RandomStream random(5, "avr waveform");
    constexpr Waveform kWaves[] = {{Waveform::Kind::Normal, Waveform::Top::Fixed, 0xFF},
                                   {Waveform::Kind::Ctc, Waveform::Top::CompareA, 0},
                                   {Waveform::Kind::Fast, Waveform::Top::CompareA, 0},
                                   {Waveform::Kind::Phase, Waveform::Top::CompareA, 0},
                                   {Waveform::Kind::PhaseFrequency, Waveform::Top::Capture, 0}};
    for (int i = 0; i < 20000; ++i) {
        const Waveform& wave = kWaves[random.below(5)];
        const std::uint32_t max = 0xFF;
        const auto top = static_cast<std::uint32_t>(wave.kind == Waveform::Kind::Normal ? max
                                                    : wave.dual_slope() ? 2 + random.below(254)
                                                                        : random.below(256));
        Counter counter{
            static_cast<std::uint32_t>(wave.dual_slope() ? random.below(top + 1) : random.below(256)), false};
        if (wave.dual_slope() && counter.count > 0) counter.down = counter.count == top || random.below(2);
        const auto value = static_cast<std::uint32_t>(random.below(256));
        const std::uint64_t ticks = random.below(1200);
        const bool blocked = random.below(4) == 0;
        INFO("kind " << static_cast<int>(wave.kind) << " top " << top << " count " << counter.count
                     << " down " << counter.down << " value " << value << " ticks " << ticks);
        std::uint32_t count = counter.count;
        bool down = counter.down;
        std::uint64_t left = kNoTick;
        for (std::uint64_t n = 1; n <= 1200; ++n) {
            if (count == value && left == kNoTick && !(blocked && n == 1)) left = n;
            tick(count, down, wave, top, max);
            if (n != ticks) continue;
            Counter after = counter;
            after.advance(ticks, wave, top, max);
            REQUIRE(after.count == count);
            if (wave.dual_slope() && count != 0) REQUIRE(after.down == down);
        }
        REQUIRE(counter.leaves(value, wave, top, max, blocked) == left);
    }
}
