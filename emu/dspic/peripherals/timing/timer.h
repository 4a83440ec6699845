#pragma once
// Timer1 to Timer5 (33FJ: to Timer9): 16-bit counters with prescaler, gate and external clock; Timer2/3,
// Timer4/5, ... pair to 32 bits. Source: dsPIC30F Family Reference Manual, section 12, and DS70286; fact
// sheet peripherals.md section 2.
//
// Deviations
//  1. External clock edges count at the instant of the edge; synchronisation (TSYNC) and asynchronous
//     counting do not differ.
//  2. Counting from the internal clock, TxIF is set in the cycle in which TMRx returns to 0; from an
//     external clock, when the count reaches PRx (what the robot's camera driver relies on).
//  3. A write to TxCON leaves the prescaler alone (family manual); one data sheet states that it clears it.
//  4. In 32-bit mode a direct write to the upper TMR has no effect until it is moved by a write to the
//     lower one.

#include "emu/dspic/peripherals/surroundings.h"

namespace puckloop::dspic {

/// One timer. Never ticks: the count is computed from the cycle in which it was last known.
class Timer {
  public:
    struct Setup {
        std::uint16_t tmr = 0;
        std::uint16_t pr = 0;
        std::uint16_t con = 0;
        std::uint8_t irq = 0;
        std::uint16_t hold = 0;     ///< TMRyHLD of the pair, for the lower timer (type B) only
        bool asynchronous = false;  ///< type A: TSYNC = 0 counts edges without the instruction clock
    };

    /// `upper` is the other half of the pair if this is its lower timer, else null.
    Timer(const Surroundings& around, const Setup& setup, Timer* upper = nullptr);

    /// Every kind of reset; the registers themselves have been reset.
    void reset();
    /// The TxCK pin changed to `level` at cycle `at`; kNoCycle: no edge, just the level after a reset.
    void clock_pin(bool level, Cycle at);
    /// Edges on TxCK make a difference at present: it counts them, or they gate it.
    bool monitors_clock_pin() const;
    /// Called after every write that may have changed monitors_clock_pin(); may stay empty.
    void (*on_monitoring)(void* owner) = nullptr;
    void* on_monitoring_owner = nullptr;
    /// Sleep, or Idle with TSIDL set: the count stands still, but for edges counted without
    /// synchronisation.
    void hold(bool on);
    /// Puts the present count into TMRx's storage.
    void refresh();

    /// Called at each period match (Timer3 triggers the A/D converter); may stay empty.
    void (*on_match)(void* owner, Cycle at) = nullptr;
    void* on_match_owner = nullptr;

    // For the modules whose time base it is.
    /// TMRx at cycle `at`, now or to come, while nobody writes to the timer.
    std::uint16_t value_at(Cycle at) const {
        return static_cast<std::uint16_t>(is_upper_half() ? lower_->count_at(at) >> 16 : count_at(at));
    }
    /// The internal clock is counted at present.
    bool counts() const { return running(); }
    /// Cycles between period matches.
    Cycle period_cycles() const { return (static_cast<Cycle>(period()) + 1) * prescale(); }
    Cycle count_cycles() const { return prescale(); }
    /// First cycle after `from` in which the count becomes `value`; kNoCycle if it never does.
    Cycle next_at(std::uint32_t value, Cycle from) const;
    /// `changed` is called after every write that may move the times of counts to come, with the first cycle
    /// of the new order; `period` at the next period match after want_period().
    void serve(void* owner, void (*changed)(void* owner, Cycle at), void (*period)(void* owner, Cycle at));
    void want_period() {
        wake(around_.now);
        period_wanted_ = true;
        announce_steady();
    }

    /// Matches that change nothing, since the flag that they raise is set and nobody hears of it, are left
    /// out of the timetable. Puts the next one after cycle `passed` back.
    void wake(Cycle passed);
    /// After registers and timetable were loaded.
    void loaded() {
        if (resting()) watch_flag();
    }

    /// After the registers.
    template <class Archive>
    void state(Archive& archive) {
        archive(state_, period_wanted_);
        if constexpr (Archive::kLoads) announce_steady();
    }

  private:
    struct State {
        std::uint32_t count = 0;     ///< at cycle `base`
        std::uint32_t fraction = 0;  ///< prescaler count at cycle `base`
        Cycle base = 0;
        bool pin = false;  ///< level of TxCK
        bool held = false;
        Cycle reload = 0;  ///< cycles to the match after the next one, while nothing but time decides; else 0

        template <class Archive>
        void state(Archive& archive) {
            archive(count, fraction, base, pin, held, reload);
        }
    };

    static std::uint16_t read_tmr(void* owner, std::uint16_t address);
    static void write_tmr(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_pr(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void match_due(void* owner, Cycle due);
    static void matches_passed(void* owner, std::uint64_t times);
    void announce_steady();  ///< to the timetable: whether matches do no more than interrupt
    bool steady() const;     ///< they do no more
    bool resting() const { return state_.reload != 0 && around_.events.due(slot_) == kNoCycle; }
    void watch_flag();  ///< to be woken when a match would change something

    bool paired() const;           ///< this lower timer counts 32 bits
    bool is_upper_half() const;    ///< this upper timer is the high word of a pair
    int irq() const;               ///< that a match raises
    bool external() const;         ///< counts edges of TxCK
    bool synchronised() const;     ///< edges of TxCK need the instruction clock
    bool gated() const;            ///< counts cycles while TxCK is high
    bool running() const;          ///< the internal clock is counted just now
    std::uint32_t period() const;  ///< PRx, or PRy:PRx of a pair
    std::uint32_t top() const { return paired() ? 0xFFFF'FFFFu : 0xFFFFu; }
    std::uint32_t prescale() const;
    std::uint32_t count_at(Cycle at) const;
    Cycle next_match() const;
    void settle(Cycle at);  ///< makes `at` the base, firing a match that falls due by then
    void plan();
    void changed(Cycle at) {
        if (changed_) changed_(served_, at);
    }
    void match(Cycle at);
    std::uint16_t con() const { return around_.sfr.raw(setup_.con); }

    Surroundings around_;
    Setup setup_;
    Timer* upper_;
    Timer* lower_ = nullptr;
    State state_;
    EventQueue::Slot slot_;
    void* served_ = nullptr;
    void (*changed_)(void*, Cycle) = nullptr;
    void (*period_)(void*, Cycle) = nullptr;
    bool period_wanted_ = false;
};

}  // namespace puckloop::dspic
