// The programs of service_paths_test.cpp, while somebody does to both cores what users do: changes the
// program, stops in routines, looks on, exchanges vector tables, loads states, goes back to marks. What was
// learned before must not show.

#include "base/states/checkpoint.h"
#include "emu/chip/instrument.h"
#include "tests/dspic/skips/path_bench.h"
#include "tests/dspic/skips/service_programs.h"
#include "tests/translate/translation_guard.h"

using namespace puckloop;
using namespace puckloop::dspic;
using namespace puckloop::dspic::test;

namespace {

struct Looker : chip::Instrument {
    bool instruction(std::uint32_t, std::uint64_t) override { return true; }
};

/// A core with what disturbs it, to be saved whole.
struct World {
    Rig rig;
    Disturbances disturbances;
    Looker looker;

    World(const std::string& source, const DeviceInfo& device, std::uint64_t seed)
        : rig(source, device), disturbances(rig, seed) {}

    template <class Archive>
    void state(Archive& archive) {
        archive.part("registers", rig.sfr);
        archive.part("core", rig.core);
        archive(rig.events, disturbances.random);
        if constexpr (!Archive::kLoads) return;
        rig.interrupts.registers_loaded();
        rig.sfr.plain().until[SfrSpace::Plain::kConverter] = 0;
    }
};

class Perturber {
  public:
    Perturber(World& fast, World& slow, std::uint64_t seed)
        : fast_(fast), slow_(slow), random_(seed, "perturber") {}

    void perturb() {
        const auto what = random_.below(14);
        done_ += " " + std::to_string(what);
        switch (what) {
        case 0:
        case 1:
            return rewrite();
        case 2:
        case 3:
            return stop();
        case 4:
            return look_on();
        case 5:
            return registers(InterruptController::kIntcon2, 0x8000);  // ALTIVT
        case 6:
            return registers(InterruptController::kIntcon1, 0x8000);  // NSTDIS
        case 7:
            return priorities();
        case 8:
            return both([value = below(0x100)](Rig& rig) { rig.core.write_data(0x34, value); });  // PSVPAG
        case 9:
            return limit_stack();
        case 10:
            return take_away();
        case 11:
            skips_ = !skips_;
            return fast_.rig.core.set_skip_idle(skips_);
        case 12:
            return load();
        default:
            return go_back();
        }
    }

    /// What was done, by its numbers.
    const std::string& done() const { return done_; }

  private:
    std::uint16_t below(std::uint64_t number) { return static_cast<std::uint16_t>(random_.below(number)); }
    template <class What>
    void both(What what) {
        what(fast_.rig);
        what(slow_.rig);
    }
    std::string routine() { return random_.below(2) ? "isr" : "other"; }

    /// The routine's literal.
    void rewrite() {
        const std::string label = routine() + "_literal";
        const std::uint32_t word = 0x200000u | std::uint32_t{below(0x10000)} << 4;
        both([&](Rig& rig) { rig.core.poke_program(rig.program.symbol(label), word); });
    }
    void stop() {
        const std::uint32_t at[] = {
            fast_.rig.program.symbol(routine() + (random_.below(2) ? "_literal" : ""))};
        const Cycle until = fast_.rig.core.cycle() + 1 + random_.below(5000);
        both([&](Rig& rig) { rig.core.set_stops(at); });
        for (std::uint64_t times = 1 + random_.below(3); times > 0; --times)
            REQUIRE(fast_.rig.core.run(until) == slow_.rig.core.run(until));
        both([](Rig& rig) { rig.core.set_stops({}); });
    }
    void look_on() {
        looks_ = !looks_;
        const bool accesses = random_.below(2);
        fast_.rig.core.set_instrument(looks_ ? &fast_.looker : nullptr, accesses);
        skips_ = true;
        if (!looks_) fast_.rig.core.set_skip_idle(true);
    }
    void registers(std::uint16_t address, std::uint16_t toggles) {
        both([&](Rig& rig) {
            rig.sfr.write(address, static_cast<std::uint16_t>(rig.sfr.raw(address) ^ toggles), toggles);
        });
    }
    void priorities() {
        const auto address = static_cast<std::uint16_t>(fast_.rig.device.ipc + 2 * below(2));
        const auto value = static_cast<std::uint16_t>(0x1111 * (1 + below(7)));
        both([&](Rig& rig) { rig.sfr.write(address, value, 0xFFFF); });
    }
    /// So narrow that a routine may meet it: the trap's handler sets it far away again.
    void limit_stack() {
        const auto limit = static_cast<std::uint16_t>(0x1C00 + 2 * below(40));
        both([&](Rig& rig) { rig.core.write_data(0x20, limit); });
    }
    void take_away() {
        const bool off = random_.below(2);
        constexpr std::uint16_t kRead[] = {kPolled, kRefreshed, kConverted, kConverted + 2, kConverted + 4};
        const std::uint16_t address = kRead[random_.below(std::size(kRead))];
        both([&](Rig& rig) { rig.sfr.set_off(address, off); });
    }
    void load() {
        if (saved_.empty() || random_.below(2)) {
            saved_.clear();
            StateWriter writer(saved_);
            slow_.state(writer);
            return;
        }
        for (World* world : {&fast_, &slow_}) {
            StateReader reader(saved_);
            world->state(reader);
        }
    }
    /// The core that skips runs ahead, is changed, and goes back.
    void go_back() {
        const std::vector<std::string> log = fast_.rig.log;
        Checkpoint checkpoint;
        checkpoint.take(fast_);
        fast_.rig.core.mark();
        fast_.rig.core.run(fast_.rig.core.cycle() + 1 + random_.below(30'000));
        if (random_.below(2)) fast_.rig.core.poke_program(fast_.rig.program.symbol("isr_literal"), 0x212340);
        fast_.rig.core.run(fast_.rig.core.cycle() + 1 + random_.below(30'000));
        checkpoint.restore(fast_);
        fast_.rig.core.rewind();
        fast_.rig.core.settle();
        fast_.rig.log = log;
    }

    World& fast_;
    World& slow_;
    RandomStream random_;
    bool looks_ = false, skips_ = true;
    std::vector<std::uint8_t> saved_;
    std::string done_;
};

/// With a literal of its own at its start.
std::string with_literal(std::string source, const std::string& name) {
    const std::string first = name + ":\n        push 0x36\n";
    const std::size_t at = source.find(first);
    REQUIRE(at != std::string::npos);
    return source.replace(at, first.size(),
                          first + "        push w0\n" + name + "_literal:\n        mov #0x1234, w0\n" +
                              "        mov w0, 0x0E60\n        pop w0\n");
}

void compare_perturbed(const DeviceInfo& device, std::uint64_t seed, Cycle length) {
    RandomStream random(seed, "service paths");
    std::string source = waiting_program(device, random);
    source = with_literal(with_literal(source, "isr"), "other") + R"(
spare:  inc 0x0E62
        bclr 0x84, #3
        retfie
trap:   push w0
        mov #0x27f0, w0
        mov w0, 0x20
        bclr 0x80, #2
        pop w0
        retfie
)";
    const tests::TranslationGuard translation(random.below(2) != 0, 1);
    World fast(source, device, seed), slow(source, device, seed);
    slow.rig.core.set_skip_idle(false);
    for (World* world : {&fast, &slow}) {
        Rig& rig = world->rig;
        rig.sfr.claim(kPolled);
        rig.sfr.claim(kRefreshed);
        rig.core.observer().on_interrupt = nullptr;
        rig.core.set_cycle_rate(1e9);  // nothing is looked at for waiting so long
        rig.vector(kTrapVectors + kT1, "isr");
        rig.vector(kTrapVectors + kT2, "other");
        rig.vector(kTrapVectors + kT1, "spare", true);
        rig.vector(kTrapVectors + kT2, "other", true);
        for (const bool alternate : {false, true})
            rig.vector(static_cast<int>(Trap::StackError), "trap", alternate);
    }
    Perturber perturber(fast, slow, seed);
    RandomStream cuts(seed, "cuts");
    for (Cycle passed = 0; passed < length;) {
        const Cycle more = 1 + cuts.below(cuts.below(4) ? 60'000 : 40);
        passed += more;
        const Cycle at = std::max(slow.rig.core.cycle(), fast.rig.core.cycle()) + more;
        fast.rig.core.run(at);
        slow.rig.core.run(at);
        fast.disturbances.drift();
        slow.disturbances.drift();
        INFO(source << "\nseed " << seed << ", at " << at << ", perturbed:" << perturber.done());
        REQUIRE(fast.rig.log == slow.rig.log);
        REQUIRE(fingerprint(fast.rig) == fingerprint(slow.rig));
        const bool same = state_of(fast.rig) == state_of(slow.rig);
        REQUIRE(same);
        perturber.perturb();
    }
}

}  // namespace

TEST_CASE("waiting loops under remembered routines, perturbed") {
    RandomStream seeds(Catch::rngSeed(), "perturbed paths");
    for (int round = 0; round < 60; ++round)
        compare_perturbed(round % 4 == 0 ? dspic33fj256gp710() : dspic30f6014a(), seeds.next(), 1'000'000);
}
