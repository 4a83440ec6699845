// Matches that nobody hears are left out of the timetable (Timer::wake()): a chip that does so beside one
// that does not, with the same accesses at the same cycles.

#include "base/random.h"
#include "base/states/archive.h"
#include "emu/dspic/peripherals/timing/timer.h"
#include "tests/dspic/peripherals/peripheral_bench.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

const Timer::Setup kFirst{sfr::TMR1, sfr::PR1, sfr::T1CON, irq::T1};
const Timer::Setup kLower{sfr::TMR2, sfr::PR2, sfr::T2CON, irq::T2, sfr::TMR3HLD};
const Timer::Setup kUpper{sfr::TMR3, sfr::PR3, sfr::T3CON, irq::T3};

struct Twin : Bench {
    Timer t3{around, kUpper};
    Timer t2{around, kLower, &t3};
    Timer t1{around, kFirst};
    std::uint64_t heard = 0;  ///< changes of who is first in line, and when
    std::uint64_t events_run = 0;

    explicit Twin(bool rests) {
        interrupts.set_resting(rests);
        interrupts.set_listener(this, [](void* owner, Cycle at) {
            Twin& self = *static_cast<Twin*>(owner);
            const auto first = static_cast<std::uint64_t>(self.interrupts.first().vector);
            self.heard = (self.heard * 1'000'003) ^ (at << 8) ^ first;
        });
        t2.serve(
            this, [](void*, Cycle) {},
            [](void* owner, Cycle at) {
                auto& self = *static_cast<Twin*>(owner);
                self.heard = self.heard * 1'000'003 + at;
            });
    }
    void run(Cycle cycle) {
        while (events.next() <= cycle) {
            now = events.next();
            events.service(now);
            ++events_run;
        }
        now = cycle;
    }
    /// As a saved state has it.
    std::vector<std::uint8_t> saved() {
        std::vector<std::uint8_t> bytes;
        StateWriter archive(bytes);
        for (Timer* timer : {&t1, &t2, &t3}) {
            timer->wake(now);
            timer->state(archive);
        }
        events.state(archive);
        sfr.state(archive);
        return bytes;
    }
};

constexpr std::uint16_t kTimers[3][3] = {
    {sfr::TMR1, sfr::PR1, sfr::T1CON}, {sfr::TMR2, sfr::PR2, sfr::T2CON}, {sfr::TMR3, sfr::PR3, sfr::T3CON}};
constexpr std::uint16_t kFlagsOfTimers = 1u << irq::T1 | 1u << irq::T2 | 1u << irq::T3;

std::uint16_t random_control(RandomStream& random) {
    constexpr std::uint16_t kOn = 0x8000, kGate = 0x0040, k32Bit = 0x0008, kExternal = 0x0002;
    std::uint16_t value = random.below(5) != 0 ? kOn : 0;
    value |= static_cast<std::uint16_t>(random.below(4) << 4);
    if (random.below(8) == 0) value |= kGate;
    if (random.below(8) == 0) value |= kExternal;
    if (random.below(4) == 0) value |= k32Bit;
    return value;
}

/// One access or one thing that happens at the pins, the same for both.
void disturb(RandomStream& random, Twin& a, Twin& b) {
    const auto both = [&](auto what) {
        what(a);
        what(b);
    };
    const auto word = static_cast<std::uint16_t>(random.next());
    const auto& timer = kTimers[random.below(3)];
    const std::uint64_t kind = random.below(12);
    const std::uint16_t control = random_control(random);
    const bool level = random.below(2) != 0;
    switch (kind) {
    case 0:
        both([&](Twin& t) { t.write(timer[0], word); });
        break;
    case 1:
        both([&](Twin& t) { t.write(timer[1], word % 700); });
        break;
    case 2:
        both([&](Twin& t) { t.write(timer[2], control); });
        break;
    case 3:
        CHECK(a.read(timer[0]) == b.read(timer[0]));
        break;
    case 4:  // a routine's BCLR
        both([&](Twin& t) { t.sfr.write(sfr::IFS0, static_cast<std::uint16_t>(~word), kFlagsOfTimers); });
        break;
    case 5:
        both([&](Twin& t) { t.sfr.write(sfr::IEC0, word, word & 0xFF00 ? kFlagsOfTimers : 0); });
        break;
    case 6: {
        const std::array<std::uint64_t, 2> tapped{std::uint64_t{word} & (word >> 4) & kFlagsOfTimers, 0};
        both([&](Twin& t) {
            t.interrupts.set_tap(
                &t,
                [](void* owner, int irq, Cycle at) {
                    auto& self = *static_cast<Twin*>(owner);
                    self.heard = self.heard * 31 + static_cast<std::uint64_t>(irq) * 7 + at;
                },
                tapped);
        });
        break;
    }
    case 7:
        both([&](Twin& t) { t.t2.want_period(); });
        break;
    case 8:
        both([&](Twin& t) { t.t1.clock_pin(level, t.now); });
        break;
    case 9:
        both([&](Twin& t) { t.t2.hold(level); });
        break;
    case 10:
        CHECK(a.t2.next_at(word % 700, a.now) == b.t2.next_at(word % 700, b.now));
        break;
    default:
        both([&](Twin& t) { t.interrupts.clear(level ? irq::T1 : irq::T3); });
        break;
    }
}

}  // namespace

TEST_CASE("timers whose matches nobody hears rest, and nothing else differs") {
    std::uint64_t run = 0, rested = 0;
    for (std::uint64_t seed = 1; seed <= 60; ++seed) {
        RandomStream random(seed, "resting timers");
        Twin plain(false), resting(true);
        for (int i = 0; i < 400; ++i) {
            const Cycle until = plain.now + random.below(random.below(4) == 0 ? 20'000 : 300);
            plain.run(until);
            resting.run(until);
            disturb(random, plain, resting);
            REQUIRE(plain.sfr.raw(sfr::IFS0) == resting.sfr.raw(sfr::IFS0));
            REQUIRE(plain.heard == resting.heard);
            if (random.below(20) == 0) REQUIRE(plain.saved() == resting.saved());
            if (random.below(100) == 0) {
                const bool rests = random.below(2) != 0;
                resting.interrupts.set_resting(rests);
            }
        }
        CHECK(plain.saved() == resting.saved());
        run += plain.events_run;
        rested += plain.events_run - resting.events_run;
    }
    CHECK(rested > run / 6);
}

TEST_CASE("a timer that rests costs no events until its flag is cleared") {
    Twin twin(true);
    twin.write(sfr::PR2, 87);
    twin.write(sfr::T2CON, 0x8000);  // counts from cycle 1 on
    twin.run(1'000'000);
    CHECK(twin.events_run == 1);
    CHECK(twin.read(sfr::TMR2) == (1'000'000 - 1) % 88);
    twin.interrupts.clear(irq::T2);
    CHECK_FALSE(twin.flag(irq::T2));
    CHECK(twin.until_flag(irq::T2, 2'000'000) == 1 + (999'999 / 88 + 1) * 88);
}
