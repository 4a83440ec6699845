#pragma once
// Two cores with one program and the same interrupts: one that skips and remembers, and one that executes
// every cycle. What the tests of remembered service routines share.

#include "base/states/archive.h"
#include "tests/dspic/rig.h"

#include <catch2/catch.hpp>

#include <deque>
#include <functional>

namespace puckloop::dspic::test {

/// Everything that a saved state of the core holds, where it waits included, and all registers.
inline std::vector<std::uint8_t> state_of(const Rig& rig) {
    std::vector<std::uint8_t> bytes;
    StateWriter writer(bytes);
    writer.part("core", rig.core);
    writer.part("registers", rig.sfr);
    return bytes;
}

struct PathBench {
    /// An event that does something every so many cycles.
    struct Beat {
        Rig* rig = nullptr;
        Cycle period = 0;
        std::function<void(Rig&, Cycle due)> does;
        EventQueue::Slot slot = 0;
    };
    Rig fast, slow;
    std::deque<Beat> beats;

    explicit PathBench(const std::string& source, const DeviceInfo& device = dspic30f6014a())
        : fast(source, device), slow(source, device) {
        slow.core.set_skip_idle(false);
        both([](Rig& rig) {
            rig.core.observer().on_interrupt = nullptr;
            rig.core.set_cycle_rate(1e9);  // nothing is looked at for waiting so long
        });
    }
    void both(const std::function<void(Rig&)>& what) {
        what(fast);
        what(slow);
    }
    void every(Cycle first, Cycle period, const std::function<void(Rig&, Cycle due)>& does) {
        both([&](Rig& rig) { add(rig, first, period, does); });
    }
    /// As a timer's: known to do nothing but raise its interrupt.
    void raises(int irq, const std::string& routine, Cycle first, Cycle period) {
        both([&](Rig& rig) {
            rig.vector(kTrapVectors + irq, routine);
            Beat& beat = add(rig, first, period, [irq](Rig& r, Cycle due) { r.interrupts.raise(irq, due); });
            rig.events.set_steady(beat.slot, {irq, period, &pass});
        });
    }
    void compare(Cycle at) {
        fast.core.run(at);
        slow.core.run(at);
        INFO("at " << at << ", " << fast.core.cycle() << " and " << slow.core.cycle() << ", pc "
                   << fast.core.pc() << " and " << slow.core.pc());
        const bool same = state_of(fast) == state_of(slow);
        REQUIRE(same);
    }

  private:
    Beat& add(Rig& rig, Cycle first, Cycle period, const std::function<void(Rig&, Cycle)>& does) {
        Beat& beat = beats.emplace_back(Beat{&rig, period, does});
        beat.slot = rig.events.add(&beat, &fire);
        rig.events.schedule(beat.slot, first);
        return beat;
    }
    static void fire(void* self, Cycle due) {
        Beat& beat = *static_cast<Beat*>(self);
        beat.does(*beat.rig, due);
        beat.rig->events.schedule(beat.slot, due + beat.period);
    }
    static void pass(void* self, std::uint64_t times) {
        Beat& beat = *static_cast<Beat*>(self);
        beat.rig->events.schedule(beat.slot, beat.rig->events.due(beat.slot) + times * beat.period);
    }
};

}  // namespace puckloop::dspic::test
