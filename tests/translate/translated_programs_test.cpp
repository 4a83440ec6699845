// A bare core with and without translation in lockstep: random programs, interrupts and changes of the
// program at random instants, random cuts and stop addresses. Everything that can be seen is compared at
// every cut.

#include "emu/dspic/core/core.h"
#include "tests/translate/random_loops.h"
#include "tests/translate/translation_guard.h"

#include <catch2/catch.hpp>

#include <algorithm>
#include <memory>

using namespace puckloop;
using namespace puckloop::tests;
using namespace puckloop::dspic;

namespace {

constexpr int kT1 = 3;

struct Subject {
    const DeviceInfo& device = dspic30f6014a();
    SfrSpace sfr;
    EventQueue events;
    InterruptController interrupts;
    Core core;
    RandomStream random;
    EventQueue::Slot beat, change;
    Cycle period;
    bool rewrites;
    std::vector<std::string> log;

    Subject(const LoopProgram& program, std::uint64_t seed)
        : interrupts(device, described(sfr, device)),
          core(device, sfr, events, interrupts),
          random(seed, "subject"),
          beat(events.add(this, &tick)),
          change(events.add(this, &rewrite)),
          period(20 + random.below(400)),
          rewrites(random.below(2) == 0) {
        for (const auto& [address, word] : program.words)
            core.poke_program(address, word);
        core.set_reset_hook([this](ResetCause) {
            sfr.reset_values();
            sfr.plain().until[SfrSpace::Plain::kConverter] = 0;
        });
        for (const std::uint16_t address : {kDrifting, kDriftingToo}) {
            sfr.hook(address, this, &read_drifting,
                     [](void*, std::uint16_t, std::uint16_t, std::uint16_t) {});
            sfr.set_plain_kind(address, SfrSpace::Plain::kConverter);
        }
        core.observer().on_reset = [this](ResetCause cause, std::uint32_t pc, Cycle now) {
            note("reset " + std::string(to_string(cause)), pc, now);
        };
        core.observer().on_trap = [this](Trap trap, std::uint32_t pc, Cycle now) {
            note("trap " + std::to_string(static_cast<int>(trap)), pc, now);
        };
        if (random.below(2))
            core.observer().on_interrupt = [this](int vector, std::uint32_t pc, Cycle now) {
                note("interrupt " + std::to_string(vector), pc, now);
            };
        core.observer().on_warning = [this](std::string_view text, std::uint32_t pc) {
            note(std::string(text), pc, 0);
        };
        core.reset(ResetCause::PowerOn);
        events.schedule(beat, period);
        events.schedule(change, 3000);
    }
    static SfrSpace& described(SfrSpace& space, const DeviceInfo& info) {
        space.describe(info.registers);
        return space;
    }
    /// Registers that change with time, brought up to date when they are read; in between they say until
    /// when a read is but a look.
    static constexpr std::uint16_t kDrifting = 0x280, kDriftingToo = 0x282;
    static constexpr Cycle kDriftPeriod = 53;
    void drift() {
        const Cycle period = core.cycle_counter() / kDriftPeriod;
        sfr.raw(kDrifting) = static_cast<std::uint16_t>(period);
        sfr.raw(kDriftingToo) = static_cast<std::uint16_t>(period * 40503u);
        sfr.plain().until[SfrSpace::Plain::kConverter] = (period + 1) * kDriftPeriod;
    }
    static std::uint16_t read_drifting(void* owner, std::uint16_t address) {
        auto& s = *static_cast<Subject*>(owner);
        s.drift();
        return s.sfr.raw(address);
    }
    void note(const std::string& what, std::uint32_t pc, Cycle now) {
        log.push_back(what + " at " + std::to_string(pc) + " in " + std::to_string(now));
    }
    static void tick(void* self, Cycle due) {
        auto& s = *static_cast<Subject*>(self);
        s.interrupts.raise(kT1, due);
        s.events.schedule(s.beat, due + 1 + s.random.below(2 * s.period));
    }
    static void rewrite(void* self, Cycle due) {
        auto& s = *static_cast<Subject*>(self);
        if (s.rewrites) {
            const auto pc = LoopProgram::kBody +
                            2 * static_cast<std::uint32_t>(s.random.below(LoopProgram::kBodyWords - 2));
            s.core.poke_program(pc, random_word(s.random, pc));
        }
        s.events.schedule(s.change, due + 1 + s.random.below(9000));
    }
};

std::vector<std::uint8_t> state_of(const Subject& s) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    CoreState state = s.core.state();
    writer(state);
    writer(s.core.instructions());
    return bytes;
}

std::vector<std::uint8_t> whole_state_of(Subject& s) {
    s.drift();
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    writer.part("registers", s.sfr);
    writer.part("core", s.core);
    return bytes;
}

std::unique_ptr<Subject> made(const LoopProgram& program, std::uint64_t seed, bool translated,
                              std::uint8_t hot) {
    const TranslationGuard guard(translated, hot);
    return std::make_unique<Subject>(program, seed);
}

void compare(std::uint64_t seed) {
    RandomStream random(seed, "translated programs");
    const LoopProgram program = random_loops(random);
    const auto hot = static_cast<std::uint8_t>(random.below(4) == 0 ? 1 + random.below(60) : 1);
    const auto fast = made(program, seed, true, hot), slow = made(program, seed, false, hot);
    const bool skips = random.below(4) != 0;
    for (Subject* s : {fast.get(), slow.get()})
        s->core.set_skip_idle(skips);
    const Cycle longest = random.below(2) ? 60 : 3000;
    constexpr int kCuts = 150;
    for (int cut = 0; cut < kCuts; ++cut) {
        const Cycle until = slow->core.cycle() + 1 + random.below(longest);
        const Core::Outcome outcome = fast->core.run(until);
        INFO("program " << seed << ", cut " << cut << " at " << until);
        REQUIRE(slow->core.run(until) == outcome);
        REQUIRE(fast->core.cycle() == slow->core.cycle());
        REQUIRE(fast->core.pc() == slow->core.pc());
        const bool same_state = state_of(*fast) == state_of(*slow);
        REQUIRE(same_state);
        const auto a = fast->core.ram(), b = slow->core.ram();
        const bool same_ram = std::equal(a.begin(), a.end(), b.begin());
        REQUIRE(same_ram);
        REQUIRE(fast->log == slow->log);
        if (random.below(20) == 0) {
            const auto at = LoopProgram::kBody + 2 * static_cast<std::uint32_t>(random.below(90));
            const std::vector<std::uint32_t> stops(random.below(2), at);
            fast->core.set_stops(stops);
            slow->core.set_stops(stops);
        }
    }
    const bool same_end = whole_state_of(*fast) == whole_state_of(*slow);
    REQUIRE(same_end);
}

}  // namespace

TEST_CASE("random programs, translated and interpreted in lockstep") {
    for (std::uint64_t seed = 0; seed < 400; ++seed)
        compare(seed);
}
