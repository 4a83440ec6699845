#pragma once
// The same program with and without busy-wait skipping, under interrupts and cuts: what their tests share.

#include "base/random.h"
#include "tests/dspic/rig.h"

#include <catch2/catch.hpp>

#include <memory>

namespace puckloop::dspic::test {

inline constexpr int kT1 = 3;
inline constexpr std::uint16_t kPolled = 0x0D8;  ///< unused word of the SFR space, plain storage

inline constexpr std::uint16_t kRefreshed = 0x0DA;  ///< the same, written by the routine without a trace

/// Raises T1 again and again and sets a polled register's bit now and then.
struct Ticker {
    Rig& rig;
    Cycle period;
    int count = 0;
    EventQueue::Slot slot;
    Ticker(Rig& owner, Cycle every) : rig(owner), period(every), slot(owner.events.add(this, &fire)) {
        rig.events.schedule(slot, period);
    }
    static void fire(void* self, Cycle due) {
        auto& t = *static_cast<Ticker*>(self);
        t.rig.interrupts.raise(kT1, due);
        if (++t.count % 7 == 0) t.rig.sfr.raw(kPolled) ^= 1;
        if (t.count % 64 == 0) t.rig.sfr.raw(kRefreshed) ^= 2;
        t.rig.events.schedule(t.slot, due + t.period);
    }
};

inline std::string fingerprint(Rig& rig) {
    const CoreState st = rig.core.state();
    std::string text = std::to_string(st.cycle) + " pc " + std::to_string(st.pc) + " sr " +
                       std::to_string(st.sr) + " instructions " + std::to_string(rig.core.instructions()) +
                       " w";
    for (const auto w : st.w)
        text += " " + std::to_string(w);
    std::uint64_t hash = 14695981039346656037u;
    for (const auto word : rig.core.ram())
        hash = (hash ^ word) * 1099511628211u;
    return text + " ram " + std::to_string(hash);
}

/// Runs both ways with the same cuts and compares after each.
inline void compare(const std::string& source, Cycle until, Cycle event_period, std::uint64_t seed) {
    Rig fast(source), slow(source);
    slow.core.set_skip_idle(false);
    for (Rig* rig : {&fast, &slow}) {
        rig->sfr.claim(kPolled);
        rig->sfr.claim(kRefreshed);
        rig->core.observer().on_interrupt = nullptr;  // it would have to be called for each
        if (rig->program.symbols.contains("isr")) rig->vector(kTrapVectors + kT1, "isr");
    }
    std::unique_ptr<Ticker> fast_ticker, slow_ticker;
    if (event_period) {
        fast_ticker = std::make_unique<Ticker>(fast, event_period);
        slow_ticker = std::make_unique<Ticker>(slow, event_period);
    }
    RandomStream cuts(seed, "cuts");
    for (Cycle at = 0; at < until;) {
        at += 1 + cuts.below(until / 4);
        fast.core.run(at);
        slow.core.run(at);
        INFO(source << "\nat " << at << ", events every " << event_period);
        REQUIRE(fingerprint(fast) == fingerprint(slow));
    }
}

inline const std::string kHead = R"(
        mov     #0x1000, w15
        mov     #0x0900, w14
        mov     #0x0A00, w8
        mov     #0x0B00, w9
        clr     w0
        clr     w1
        clr     w2
        clr     w3
        bset    0x8c, #3
)";
inline const std::string kTail = R"(
done:   inc     w12, w12
        bra     again
isr:    push    w0
        inc     w13, w13
        btsc    w13, #4
        inc     [w9], [w9]
        bclr    0x84, #3
        pop     w0
        retfie
)";

}  // namespace puckloop::dspic::test
