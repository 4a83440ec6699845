#pragma once
// Output compare modules OC1 to OC8: single edges, pulses, toggle and PWM on Timer2 or Timer3.
// Source: dsPIC30F Family Reference Manual, section 14 (DS70061), and DS70286, output compare chapter; fact
// sheet peripherals.md section 5.
//
// Deviations
//  1. A board that does not want PWM's edges (Pins::wants_pwm_edges()) sees its pin rest low, and hears of
//     period and duty instead, Pins::output_compare_changed().
//  2. In 32-bit mode of the timers the compare wants the high word 0; a timer that counts an external clock
//     is no time base.
//  3. 33FJ: an edge and its interrupt take place in the cycle in which the count is reached.
//  4. PWM's edges take place in the cycle in which the count is reached (TMRy = 0, TMRy = OCxR).
//  5. The glitch at 0 % duty of the 30F's revision B0 comes only where it is asked for
//  (Erratum::PwmZeroDuty),
//     at a pin whose board wants PWM's edges: one instruction cycle long, once each time the duty becomes 0;
//     the period behind it stays low whatever its duty. Length and occasion are assumptions.

#include "emu/dspic/devices/errata.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"
#include "emu/dspic/peripherals/timing/output_compare_state.h"
#include "emu/dspic/peripherals/timing/timer.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace puckloop::dspic {

class OutputCompare {
  public:
    struct Unit {
        std::uint16_t rs = 0;  ///< OCxRS; OCxR and OCxCON follow
        std::uint8_t irq = 0;
        PortLetter port{};
        std::uint8_t pin = 0;
    };
    struct Setup {
        std::span<const Unit> units;      ///< OC1 on
        std::array<Ports::Pin, 2> fault;  ///< OCFA of OC1 to OC4, OCFB of the others
        Cycle pin_delay = 0;              ///< from the compare match to the edge at the pin
        Cycle flag_delay = 0;             ///< from there to OCxIF
    };
    /// `timers`: Timer2 and Timer3.
    OutputCompare(const Surroundings& around, const Setup& setup, std::array<Timer*, 2> timers, Ports& ports,
                  Pins& pins);

    void reset();
    void set_errata(const Errata& errata) { glitches_ = errata.has(Erratum::PwmZeroDuty); }
    /// Sleep, or Idle for modules with OCSIDL set: matches do nothing. Faults act all the same.
    void hold(bool sleeps, bool idles) {
        if (used_) set_hold(sleeps, idles);
    }
    /// Of OC`unit`, counted from 1.
    OutputCompareState present(int unit) const;

    template <class Archive>
    void state(Archive& archive) {
        archive(used_);
        if constexpr (Archive::kLoads)
            if (!used_)
                for (State& state : states_)
                    state = {};
        if (used_) archive.fixed(states_);
    }

  private:
    static constexpr std::size_t kFirstOfB = 4;  ///< index of OC5: the first that OCFB switches off
    enum class Step : std::uint8_t { Idle, First, Second };  ///< the edge to come: at OCxR, at OCxRS
    struct State {
        Step step = Step::Idle;
        bool level = false;
        bool held = false;
        bool glitch = false;         ///< high for a cycle, at a duty of 0
        bool missed = false;         ///< the next period stays low
        Cycle due = kNoCycle;        ///< of the edge to come
        Cycle interrupt = kNoCycle;  ///< when OCxIF is set for the last one
        OutputCompareState reported;

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(step, Step::Idle, Step::Second);
            archive(level, held, glitch, missed, due, interrupt, reported);
        }
    };

    /// Timer2 or Timer3, as it calls back.
    struct Base {
        OutputCompare* self = nullptr;
        Timer* timer = nullptr;
    };
    /// OCFA or OCFB, as the ports call back.
    struct FaultInput {
        OutputCompare* self = nullptr;
        std::size_t first = 0, last = 0;  ///< units that it switches off
    };

    static void write_rs(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_r(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void timer_changed(void* owner, Cycle at);
    static void period_over(void* owner, Cycle at);
    static void due(void* owner, Cycle due);
    static void fault_changed(void* owner, bool level, Cycle at);

    std::size_t index_of(std::uint16_t address) const;
    int mode(std::size_t index) const;
    bool pwm(std::size_t index) const { return mode(index) >= 6; }
    bool pwm_edges(std::size_t index) const;
    bool faulted(std::size_t index) const;
    void fault(std::size_t index, Cycle at);
    void begin_period(std::size_t index, Cycle at);
    void begin_glitch(std::size_t index, Cycle at);
    void set_hold(bool sleeps, bool idles);
    Timer& timer(std::size_t index) const;
    void begin(std::size_t index);
    void edge(std::size_t index, Cycle at);
    void drive(std::size_t index, Cycle at);
    void plan(std::size_t index, Cycle from);
    void plan_all();
    void replan(std::size_t index, Cycle at);
    void notify_board(std::size_t index, Cycle at);
    std::uint16_t& rs(std::size_t index) const { return around_.sfr.raw(units_[index].rs); }
    std::uint16_t& r(std::size_t index) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(units_[index].rs + 2));
    }
    std::uint16_t& con(std::size_t index) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(units_[index].rs + 4));
    }

    Surroundings around_;
    Setup setup_;
    std::span<const Unit> units_;
    std::array<Base, 2> bases_;
    std::array<FaultInput, 2> faults_;
    Ports& ports_;
    Pins& pins_;
    bool glitches_ = false;  ///< Erratum::PwmZeroDuty
    bool used_ = false;      ///< a module was ever switched on: there is something to remember
    std::vector<State> states_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
