#pragma once
// Output compare modules OC1 to OC8: single edges, pulses, toggle and PWM on Timer2 or Timer3.
// Source: DS70286, output compare chapter; fact sheet peripherals.md section 5.
//
// Deviations
//  1. PWM (and nothing else) has no waveform at its pin, which rests low: period and duty are reported
//  instead,
//     Pins::output_compare_changed().
//  2. The fault inputs OCFA and OCFB never act; OCFLT reads 0.
//  3. In 32-bit mode of the timers the compare looks at the low word only.
//  4. An edge takes place in the cycle in which the count is reached.

#include "emu/dspic/peripherals/output_compare_state.h"
#include "emu/dspic/peripherals/pins.h"
#include "emu/dspic/peripherals/ports.h"
#include "emu/dspic/peripherals/surroundings.h"
#include "emu/dspic/peripherals/timer.h"

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
    /// `units`: OC1 on. `timers`: Timer2 and Timer3.
    OutputCompare(const Surroundings& around, std::span<const Unit> units, std::array<Timer*, 2> timers,
                  Ports& ports, Pins& pins);

    void reset();
    /// Of OC`unit`, counted from 1.
    OutputCompareState present(int unit) const;

    template <class Archive>
    void state(Archive& archive) {
        archive.fixed(states_);
    }

  private:
    enum class Step : std::uint8_t { Idle, First, Second };  ///< the edge to come: at OCxR, at OCxRS
    struct State {
        Step step = Step::Idle;
        bool level = false;
        Cycle due = kNoCycle;
        OutputCompareState reported;

        template <class Archive>
        void state(Archive& archive) {
            archive.bounded(step, Step::Idle, Step::Second);
            archive(level, due, reported);
        }
    };

    /// Timer2 or Timer3, as it calls back.
    struct Base {
        OutputCompare* self = nullptr;
        Timer* timer = nullptr;
    };

    static void write_rs(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_r(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void write_con(void* owner, std::uint16_t address, std::uint16_t value, std::uint16_t mask);
    static void timer_changed(void* owner, Cycle at);
    static void period_over(void* owner, Cycle at);
    static void due(void* owner, Cycle due);

    std::size_t index_of(std::uint16_t address) const;
    int mode(std::size_t index) const;
    bool pwm(std::size_t index) const { return mode(index) >= 6; }
    Timer& timer(std::size_t index) const;
    void begin(std::size_t index);
    void edge(std::size_t index, Cycle at);
    void drive(std::size_t index);
    void plan(std::size_t index, Cycle from);
    void plan_all();
    void tell(std::size_t index, Cycle at);
    std::uint16_t& rs(std::size_t index) const { return around_.sfr.raw(units_[index].rs); }
    std::uint16_t& r(std::size_t index) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(units_[index].rs + 2));
    }
    std::uint16_t& con(std::size_t index) const {
        return around_.sfr.raw(static_cast<std::uint16_t>(units_[index].rs + 4));
    }

    Surroundings around_;
    std::span<const Unit> units_;
    std::array<Base, 2> bases_;
    Ports& ports_;
    Pins& pins_;
    std::vector<State> states_;
    EventQueue::Slot slot_;
};

}  // namespace puckloop::dspic
