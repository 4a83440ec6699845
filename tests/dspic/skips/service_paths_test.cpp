// Waiting loops under interrupts whose routines count, compare and copy: a core that passes routines by the
// paths it remembers, and goes from one event to the next inside the loop, beside one that executes every
// instruction. Routines, counters, instants of interrupts, changes from outside and cuts are drawn.

#include "tests/dspic/skips/path_bench.h"
#include "tests/dspic/skips/service_programs.h"
#include "tests/translate/translation_guard.h"

#include <catch2/catch.hpp>

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

void compare_services(const DeviceInfo& device, std::uint64_t seed, Cycle until) {
    RandomStream random(seed, "service paths");
    const std::string source = waiting_program(device, random);
    const tests::TranslationGuard translation(random.below(2) != 0, 1);
    Rig fast(source, device), slow(source, device);
    slow.core.set_skip_idle(false);
    for (Rig* rig : {&fast, &slow}) {
        rig->sfr.claim(kPolled);
        rig->sfr.claim(kRefreshed);
        rig->core.observer().on_interrupt = nullptr;
        rig->core.set_cycle_rate(1e9);  // nothing is looked at for waiting so long
        rig->vector(kTrapVectors + kT1, "isr");
        rig->vector(kTrapVectors + kT2, "other");
    }
    Disturbances fast_world(fast, seed), slow_world(slow, seed);
    RandomStream cuts(seed, "cuts");
    for (Cycle at = 0; at < until;) {
        at += 1 + cuts.below(cuts.below(4) ? until / 8 : 40);
        fast.core.run(at);
        slow.core.run(at);
        fast_world.drift();
        slow_world.drift();
        INFO(source << "\nseed " << seed << ", at " << at);
        REQUIRE(fingerprint(fast) == fingerprint(slow));
        const bool same = state_of(fast) == state_of(slow);
        REQUIRE(same);
    }
}

}  // namespace

TEST_CASE("waiting loops under routines that count and copy, in steps and executed") {
    RandomStream seeds(Catch::rngSeed(), "service paths");
    for (int round = 0; round < 300; ++round)
        compare_services(round % 4 == 0 ? dspic33fj256gp710() : dspic30f6014a(), seeds.next(), 300'000);
}
